#pragma once

#include <cstddef>
#include <optional>

#include "adjustment/map_builder.h"
#include "adjustment/recording.h"

namespace omnitag {

/// Without a seed: chooses the frame that shows most, takes its pose as the origin, and places its
/// markers by their corners alone. Returns the frame.
std::size_t startFromOneFrame(Recording* recording, const MapBuilderConfig& config);

/// Estimates poses of frames from placed markers, places the markers that they show, and adjusts
/// everything, until nothing more can be added.
void grow(Recording* recording, std::optional<std::size_t> held_frame,
          const MapBuilderConfig& config);

}  // namespace omnitag
