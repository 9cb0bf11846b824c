#pragma once

#include <string>

#include "omnitag/adjustment/map_builder.h"

namespace omnitag {

/// Draws a map from above: markers with their fronts and ids, the seed's black, new ones blue with
/// ellipses of a hundred standard deviations, and the robot's way. Throws InputError where the file
/// cannot be written.
void drawMap(const BuiltMap& map, const std::string& path);

}  // namespace omnitag
