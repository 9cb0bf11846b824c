#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "adjustment/map_builder.h"
#include "adjustment/recording.h"

namespace omnitag {

/// Markers that many readings contradict, because they have another size or were moved.
struct ContradictedMarkers {
  /// Which marker, and what it seems to be, a line each.
  std::vector<std::string> remarks;
  /// Markers that no single place explains, except the seed's, which stay.
  std::vector<std::size_t> left_out;
};

/// Finds, for each marker that many readings contradict, its size, or where it hung and when.
/// Throws DegenerateRecording for a marker that hangs at several places at once.
ContradictedMarkers contradictedMarkers(const Recording& recording, const MapBuilderConfig& config);

/// Distance of a reading from where a marker images, RMS over its corners, in pixels.
double residualOf(const Recording& recording, const ReadingIndex& place, const Marker& marker);

}  // namespace omnitag
