#pragma once

#include <set>
#include <string>

#include "marker/apriltag_family.h"

namespace omnitag {

/// The names of OpenCV's predefined ArUco dictionaries, such as DICT_5X5_100.
const std::set<std::string>& arucoDictionaries();

/// The number of ids in the dictionary of that name.
int arucoCount(const std::string& name);

/// The dictionary of that name as codes for the AprilTag library, which then finds, decodes and
/// draws its markers like its own: as OpenCV draws them, with a black border of one module and a
/// white one around it. At most as many wrong bits are corrected as OpenCV considers safe.
AprilTagFamily createArucoFamily(const std::string& name);

}  // namespace omnitag
