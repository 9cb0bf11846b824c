#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "omnitag/camera/camera_file.h"
#include "omnitag/common/angle.h"

namespace omnitag::test {

/// 500 x 500 pixels, a sphere, the disc 400 pixels across.
inline std::shared_ptr<const CameraModel> sphericalCamera() {
  return parseCamera(R"(
model: catadioptric
image: {width: 500, height: 500}
lens: {fx: 1234, fy: 1234, cx: 249.5, cy: 249.5}
mirror: {profile: spherical, radius_of_curvature: 0.04, apex_distance: 0.21, rim_radius: 0.0395}
)",
                     "sphere");
}

/// 1024 x 768 pixels, a hyperbola off its focus, a lens with unequal focal lengths and distortion.
inline std::shared_ptr<const CameraModel> hyperbolicCamera() {
  return parseCamera(R"(
model: catadioptric
image: {width: 1024, height: 768}
lens: {fx: 1500, fy: 1490, cx: 520.3, cy: 380.1, distortion: [-0.05, 0.01, 0.0004, -0.0003, 0]}
mirror: {profile: hyperbolic, radius_of_curvature: 0.03, conic_constant: -1.6, apex_distance: 0.15,
         rim_radius: 0.032}
)",
                     "hyperbola");
}

/// A camera that looks down on its mirror, turned, off the robot's middle and a little tilted.
inline Eigen::Isometry3d lookingDown() {
  return Eigen::Translation3d(0.10, -0.05, 1.1) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(kPi - 0.03, Eigen::Vector3d::UnitX());
}

/// A camera that looks up at its mirror.
inline Eigen::Isometry3d lookingUp() {
  return Eigen::Translation3d(-0.05, 0.02, 0.8) *
         Eigen::AngleAxisd(-1.1, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY());
}

}  // namespace omnitag::test
