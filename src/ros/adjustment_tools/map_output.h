#pragma once

#include <string>

#include "adjustment/map_builder.h"
#include "ros/adjustment_tools/alignment_options.h"
#include "ros/adjustment_tools/drive.h"

namespace omnitag {

/// Puts the map and the robot's path into the other frame, and adds to the remarks how well that
/// fits. Throws InputError if it does not fit.
void align(const AlignmentRequest& request, const Drive& drive, BuiltMap* map);

/// Prints the map: each marker's place and how well it is known, the worst readings, remarks, and
/// what to do next.
void printMap(const BuiltMap& map);

/// The text of the map file, to be written to `path`: the seed's text with the new markers at the
/// end, where exact entries keep their places and others get better ones. It is a new text without
/// a seed (empty path), if the map's frame is not the seed's, or in another folder if there are
/// pictures, whose paths are relative to it.
std::string mapText(const std::string& seed_path, const std::string& frame, const BuiltMap& map,
                    const std::string& path);

}  // namespace omnitag
