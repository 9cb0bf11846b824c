#pragma once

#include <set>
#include <string>

#include "apriltag_family.h"

namespace omnitag {

/// The names of OpenCV's predefined ArUco dictionaries, such as DICT_5X5_100.
const std::set<std::string>& arucoDictionaries();

/// How many ids the dictionary of that name has.
int arucoCount(const std::string& name);

/// The dictionary of that name as codes for the AprilTag library, which then finds, decodes and
/// draws its markers as it does its own: as OpenCV draws them, with a black border of one module
/// and a white one around it. It corrects as many wrong bits as OpenCV says are safe, at most.
AprilTagFamily createArucoFamily(const std::string& name);

}  // namespace omnitag
