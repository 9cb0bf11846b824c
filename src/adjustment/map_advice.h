#pragma once

#include <string>
#include <vector>

#include "adjustment/built_map.h"

namespace omnitag {

/// What to do next to make a map better, a line each: for the markers that are known worse than a
/// tape measure tells (5 mm), or are left out for that, what would help, wall by wall. A marker
/// that was seen from directions less than 30 degrees apart is to be driven past, one that was read
/// in fewer than ten images is to be kept in sight, any other is to be driven nearer to. The last
/// line says how well the other markers are known. Empty if no marker was found.
std::vector<std::string> adviceOn(const BuiltMap& map);

}  // namespace omnitag
