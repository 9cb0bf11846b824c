#pragma once

#include <apriltag/apriltag.h>

#include <functional>
#include <memory>
#include <string>

namespace omnitag {

/// A family in the AprilTag library's form.
using AprilTagFamily = std::unique_ptr<apriltag_family_t, std::function<void(apriltag_family_t*)>>;

/// Throws InputError for an unknown family.
AprilTagFamily createAprilTagFamily(const std::string& name);

}  // namespace omnitag
