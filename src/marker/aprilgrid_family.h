#pragma once

#include "marker/apriltag_family.h"

namespace omnitag {

/// The tags of Kalibr's AprilGrid: the codes of tag36h11 in a black border of two modules.
constexpr const char* kAprilGridFamily = "aprilgrid";

AprilTagFamily createAprilGridFamily();

}  // namespace omnitag
