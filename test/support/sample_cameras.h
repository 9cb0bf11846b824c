#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "camera/ocam_camera.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/angle.h"

namespace omnitag::test {

/// 500 x 500 pixels, a sphere, the disc 400 pixels across.
inline std::shared_ptr<const CameraModel> sphericalCamera() {
  return parseCamera(R"(
model: catadioptric
image: {width: 500, height: 500}
uncertainty: none
lens: {fx: 1234, fy: 1234, cx: 249.5, cy: 249.5}
mirror: {profile: spherical, radius_of_curvature: 0.04, apex_distance: 0.21, rim_radius: 0.0395}
)",
                     "sphere");
}

/// The same with 1000 x 1000 pixels.
inline std::shared_ptr<const CameraModel> largeSphericalCamera() {
  return parseCamera(R"(
model: catadioptric
image: {width: 1000, height: 1000}
uncertainty: none
lens: {fx: 2468, fy: 2468, cx: 499.5, cy: 499.5}
mirror: {profile: spherical, radius_of_curvature: 0.04, apex_distance: 0.21, rim_radius: 0.0395}
)",
                     "large sphere");
}

/// 1024 x 768 pixels, a hyperbola off its focus, a lens with unequal focal lengths and distortion.
inline std::shared_ptr<const CameraModel> hyperbolicCamera() {
  return parseCamera(R"(
model: catadioptric
image: {width: 1024, height: 768}
uncertainty: none
lens: {fx: 1500, fy: 1490, cx: 520.3, cy: 380.1, distortion: [-0.05, 0.01, 0.0004, -0.0003, 0]}
mirror: {profile: hyperbolic, radius_of_curvature: 0.03, conic_constant: -1.6, apex_distance: 0.15,
         rim_radius: 0.032}
)",
                     "hyperbola");
}

/// Fisheyes of 190 degrees or a little less, 700 x 700 pixels, one of each central model.
inline std::shared_ptr<const CameraModel> equidistantCamera() {
  return parseCamera(R"(
model: equidistant
image: {width: 700, height: 700}
uncertainty: none
lens: {fx: 210, fy: 208, cx: 352.3, cy: 347.1}
distortion: [-0.012, 0.003, -0.0008, 0.0001]
max_angle: 1.65
)",
                     "equidistant");
}

inline std::shared_ptr<const CameraModel> unifiedCamera() {
  return parseCamera(R"(
model: unified
image: {width: 700, height: 700}
uncertainty: none
lens: {fx: 440, fy: 442, cx: 347.7, cy: 351.2, skew: 0.8}
xi: 1.4
distortion: [-0.08, 0.03, 0.0004, -0.0006]
max_angle: 1.6
)",
                     "unified");
}

inline std::shared_ptr<const CameraModel> doubleSphereCamera() {
  return parseCamera(R"(
model: double_sphere
image: {width: 700, height: 700}
uncertainty: none
lens: {fx: 182, fy: 183, cx: 348.9, cy: 350.6}
xi: -0.18
alpha: 0.59
max_angle: 1.65
)",
                     "double sphere");
}

inline std::shared_ptr<const CameraModel> eucmCamera() {
  return parseCamera(R"(
model: eucm
image: {width: 700, height: 700}
uncertainty: none
lens: {fx: 225, fy: 224, cx: 350.2, cy: 348.1}
alpha: 0.62
beta: 1.08
max_angle: 1.62
)",
                     "eucm");
}

/// A panorama of the whole sphere.
inline std::shared_ptr<const CameraModel> equirectangularCamera() {
  return parseCamera(
      "{model: equirectangular, image: {width: 1440, height: 720}, uncertainty: none}", "panorama");
}

inline std::shared_ptr<const CameraModel> ocamCamera() {
  return std::make_shared<OcamCamera>(
      OcamCalibration{
          {-180.1, 0.0, 1.9e-3, -2.1e-6, 6.3e-9}, 351.4, 346.2, 1.002, 1e-3, -2e-3, {700, 700}},
      FieldLimits{1.64, false});
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
