#pragma once

#include <Eigen/Geometry>

namespace omnitag {

/// tf's angles of a rotation: Rz(yaw) Ry(pitch) Rx(roll); pitch in [-pi/2, pi/2].
Eigen::Vector3d rollPitchYaw(const Eigen::Matrix3d& rotation);

/// The rotation of these angles.
Eigen::Matrix3d fromRollPitchYaw(const Eigen::Vector3d& roll_pitch_yaw);

/// A camera's mounting on a robot that moves on the floor, taken apart into what images can tell
/// and what they cannot. From images alone nobody can tell where on the robot the camera sits and
/// which way it is turned about the vertical: x, y and yaw of the mounting are the same as another
/// place and heading of the robot. What they do tell: the height and how the camera leans.
class LeaningMounting {
 public:
  /// z (m), roll and pitch (rad), as in tf.
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
  double yaw_;
  Values values_;
};

/// rad, of a camera's optical axis off the vertical.
double leanOf(const Eigen::Isometry3d& base_from_camera);

}  // namespace omnitag
