#pragma once

#include <apriltag/apriltag.h>

#include <memory>
#include <string>

namespace omnitag {

/// A family of the AprilTag library.
using AprilTagFamily = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

/// Throws InputError for a family that the library does not have.
AprilTagFamily createAprilTagFamily(const std::string& name);

}  // namespace omnitag
