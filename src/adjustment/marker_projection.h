#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "camera/mounted_camera.h"
#include "common/rotation.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A small change of a marker's place: a shift along the map's axes (m), then a rotation vector in
/// the map's axes (rad) that turns it about its centre.
using MarkerIncrement = Eigen::Matrix<double, 6, 1>;
using MarkerCovariance = Eigen::Matrix<double, 6, 6>;

/// The marker's place after the change.
Eigen::Isometry3d moved(const Eigen::Isometry3d& map_from_marker, const MarkerIncrement& increment);

/// The left Jacobian of the rotations: J with rotationOf(v + d) = rotationOf(J d) rotationOf(v) for
/// small d.
Eigen::Matrix3d leftJacobian(const Eigen::Vector3d& rotation_vector);

/// Four corners in the panorama as one vector: u and v of each in turn, in pixels.
using CornerPixels = Eigen::Matrix<double, 8, 1>;

CornerPixels stacked(const Corners<Eigen::Vector2d>& corners);

/// The pixels of a marker's corners, and their derivatives by the robot's pose (a PoseVector), by
/// the imaging error, by a MarkerIncrement, and by the marker's size; per metre, per radian and per
/// standard deviation.
struct MarkerProjection {
  CornerPixels pixels;
  Eigen::Matrix<double, 8, 6> by_pose;
  Eigen::Matrix<double, 8, kImagingUnknowns> by_error;
  Eigen::Matrix<double, 8, 6> by_marker;
  CornerPixels by_size;
};

/// Nothing if the camera does not see all four corners. Does not check whether the marker faces
/// the camera.
std::optional<MarkerProjection> projectMarker(const Marker& marker, const MountedCamera& camera,
                                              const Pose& map_from_base);

}  // namespace omnitag
