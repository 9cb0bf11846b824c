#pragma once

#include <set>
#include <string>

namespace omnitag {

/// The names of all families of codes that maps can use: those of the installed AprilTag library,
/// Kalibr's AprilGrid, and OpenCV's ArUco dictionaries.
const std::set<std::string>& tagFamilies();

/// How many ids a family has; throws InputError for an unknown family.
int tagCount(const std::string& family);

}  // namespace omnitag
