#pragma once

#include <string>

#include "adjustment/map_builder.h"

namespace omnitag {

/// Draws a map from above: markers with their fronts and ids, the seed's in black, new ones in blue
/// with ellipses of a hundred standard deviations; and the robot's path. Throws InputError if the
/// file cannot be written.
void drawMap(const BuiltMap& map, const std::string& path);

}  // namespace omnitag
