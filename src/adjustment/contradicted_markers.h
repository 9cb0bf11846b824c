#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "omnitag/adjustment/map_builder.h"
#include "recording.h"

namespace omnitag {

/// Markers that many readings contradict, as they are of another size, or were moved.
struct ContradictedMarkers {
  /// Which one, and what it seems to be, a line each.
  std::vector<std::string> remarks;
  /// Those that no place explains; not of the seed, whose markers stay.
  std::vector<std::size_t> left_out;
};

/// Of each marker that many readings contradict, its size or where it hung when. Throws
/// DegenerateRecording for one that hangs at several places at once.
ContradictedMarkers contradictedMarkers(const Recording& recording, const MapBuilderConfig& config);

/// Pixels, RMS over its corners, by which a reading is off from where a marker images.
double residualOf(const Recording& recording, const ReadingPlace& place, const Marker& marker);

}  // namespace omnitag
