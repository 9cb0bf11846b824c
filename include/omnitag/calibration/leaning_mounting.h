#pragma once

#include <Eigen/Geometry>

namespace omnitag {

/// A camera's mounting on a robot that moves on the floor, taken apart into what images can tell
/// and what they cannot. From images alone nobody can tell where on the robot the camera sits and
/// which way it is turned about the vertical: x, y and yaw of the mounting are the same as another
/// place and heading of the robot.
///
/// What they do tell: the height z (m) above the floor and how the camera leans, the rotation
/// vector (roll, pitch, 0) (rad) of base_link that brings a vertical optical axis to where it is.
class LeaningMounting {
 public:
  /// (z, roll, pitch).
  using Values = Eigen::Vector3d;

  /// x, y and yaw are those of this mounting. Throws InputError where the optical axis is nearer to
  /// the horizontal than to the vertical.
  explicit LeaningMounting(const Eigen::Isometry3d& base_from_camera);

  /// Of the mounting that it was made from.
  const Values& values() const { return values_; }

  /// base_from_camera.
  Eigen::Isometry3d at(const Values& values) const;

 private:
  Eigen::Vector2d position_;
  /// The rotation base_from_camera of the camera that does not lean.
  Eigen::Matrix3d upright_;
  Values values_;
};

}  // namespace omnitag
