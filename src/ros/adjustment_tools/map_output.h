#pragma once

#include <string>

#include "alignment_options.h"
#include "drive.h"
#include "omnitag/adjustment/map_builder.h"

namespace omnitag {

/// Puts the map, and the robot's way, into the other frame, and adds to its remarks how well that
/// fits. Throws InputError where it does not.
void align(const AlignmentRequest& request, const Drive& drive, BuiltMap* map);

/// What the map holds, for people: each marker's place and how well it is known, the worst
/// readings, remarks.
void printMap(const BuiltMap& map);

/// The text of the map's file: that of the seed, whose entries keep their places where they are
/// exact and get better ones where they are not, with the new markers at the end; a new one where
/// there is no seed (empty), or where the map is in another frame than it.
std::string mapText(const std::string& seed_path, const std::string& frame, const BuiltMap& map);

}  // namespace omnitag
