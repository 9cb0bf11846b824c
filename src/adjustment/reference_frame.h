#pragma once

#include <cstddef>

#include "recording.h"

/// The frame of a map without a seed.
namespace omnitag {

/// The marker that was read first of those that are placed; of several in one image the largest.
/// Throws DegenerateRecording where none is.
std::size_t referenceOf(const Recording& recording);

/// Expresses all in the frame of one of its markers: on the floor below its centre, x along its
/// normal's heading, or along its own x axis where it lies.
void transformTo(std::size_t reference, Recording* recording);

}  // namespace omnitag
