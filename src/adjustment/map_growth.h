#pragma once

#include <cstddef>
#include <optional>

#include "omnitag/adjustment/map_builder.h"
#include "recording.h"

namespace omnitag {

/// Without a seed: chooses the frame that shows most, takes its pose for the origin, and places the
/// markers that it shows by their corners alone. Returns the frame.
std::size_t startFromOneFrame(Recording* recording, const MapBuilderConfig& config);

/// Gives frames poses by the markers that are placed, places the markers that they show, adjusts
/// all, and so on until nothing more can be added.
void grow(Recording* recording, std::optional<std::size_t> held_frame,
          const MapBuilderConfig& config);

}  // namespace omnitag
