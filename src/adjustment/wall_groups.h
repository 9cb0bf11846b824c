#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The indices of the markers, grouped by the wall, the floor or the ceiling on which they hang:
/// those that face the same way (within 15 degrees) and lie in one plane (within half a metre).
/// Groups and indices are in the order of the markers.
std::vector<std::vector<std::size_t>> groupedByWall(const std::vector<Marker>& markers);

/// Where some markers of one group hang, in the map's coordinates (m): "on the wall at x = 9.2 m",
/// "on the wall around (9.2, 4.1)" if it is parallel to neither axis, "on the floor", "under the
/// ceiling"; for a single marker "at (9.2, 4.1)".
std::string placeOf(const std::vector<Marker>& markers);

}  // namespace omnitag
