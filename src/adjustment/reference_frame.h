#pragma once

#include <cstddef>

#include "adjustment/recording.h"

/// The frame of a map without a seed.
namespace omnitag {

/// The placed marker that was read first; of several in one image the largest. Throws
/// DegenerateRecording if there is none.
std::size_t referenceOf(const Recording& recording);

/// Transforms everything to the frame of one of its markers: on the floor below its centre, x along
/// its normal's heading, or along its own x axis if it lies.
void transformTo(std::size_t reference, Recording* recording);

}  // namespace omnitag
