#pragma once

#include <Eigen/Geometry>

namespace omnitag {

/// The rotation's angles as in tf: Rz(yaw) Ry(pitch) Rx(roll); pitch in [-pi/2, pi/2].
Eigen::Vector3d rollPitchYaw(const Eigen::Matrix3d& rotation);

/// The inverse.
Eigen::Matrix3d fromRollPitchYaw(const Eigen::Vector3d& roll_pitch_yaw);

/// A camera's mounting on a robot that moves on the floor, split into what images determine and
/// what they do not. They do not determine where on the robot the camera sits or how it is turned
/// about the vertical: a change of the mounting's x, y and yaw is equivalent to another place and
/// heading of the robot. They do determine the height and how the camera leans.
class LeaningMounting {
 public:
  /// z (m), roll and pitch (rad), as in tf.
  using Values = Eigen::Vector3d;

  /// x, y and yaw stay those of this mounting. Throws InputError if its pitch is beyond 60 degrees:
  /// roll and yaw then turn about nearly the same axis.
  explicit LeaningMounting(const Eigen::Isometry3d& base_from_camera);

  /// The values of the constructor's mounting.
  const Values& values() const { return values_; }

  /// base_from_camera.
  Eigen::Isometry3d at(const Values& values) const;

 private:
  Eigen::Vector2d position_;
  double yaw_;
  Values values_;
};

/// Whether the camera's optical axis is nearer to the vertical than to the horizontal.
bool isUpright(const Eigen::Isometry3d& base_from_camera);

/// Angle between the camera's optical axis and the vertical, in rad.
double leanOf(const Eigen::Isometry3d& base_from_camera);

}  // namespace omnitag
