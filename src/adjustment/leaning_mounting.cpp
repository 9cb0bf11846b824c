#include "adjustment/leaning_mounting.h"

#include <cmath>
#include <string>

#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {

Eigen::Vector3d rollPitchYaw(const Eigen::Matrix3d& rotation) {
  return {std::atan2(rotation(2, 1), rotation(2, 2)),
          std::atan2(-rotation(2, 0), std::hypot(rotation(2, 1), rotation(2, 2))),
          std::atan2(rotation(1, 0), rotation(0, 0))};
}

Eigen::Matrix3d fromRollPitchYaw(const Eigen::Vector3d& roll_pitch_yaw) {
  return (Eigen::AngleAxisd(roll_pitch_yaw.z(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(roll_pitch_yaw.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll_pitch_yaw.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

LeaningMounting::LeaningMounting(const Eigen::Isometry3d& base_from_camera)
    : position_(base_from_camera.translation().head<2>()) {
  const Eigen::Vector3d angles = rollPitchYaw(base_from_camera.linear());
  if (std::abs(angles.y()) > radians(60.0)) {
    throw InputError("mounting: expected a pitch within 60 degrees of the level, found " +
                     std::to_string(std::lround(degrees(angles.y()))) +
                     ": a camera that lies on its side cannot be calibrated");
  }
  values_ = {base_from_camera.translation().z(), angles.x(), angles.y()};
  yaw_ = angles.z();
}

Eigen::Isometry3d LeaningMounting::at(const Values& values) const {
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
  base_from_camera.linear() = fromRollPitchYaw({values.y(), values.z(), yaw_});
  base_from_camera.translation() = Eigen::Vector3d(position_.x(), position_.y(), values.x());
  return base_from_camera;
}

bool isUpright(const Eigen::Isometry3d& base_from_camera) {
  return leanOf(base_from_camera) < radians(45.0);
}

double leanOf(const Eigen::Isometry3d& base_from_camera) {
  const Eigen::Vector3d axis = base_from_camera.linear().col(2);
  return std::atan2(axis.head<2>().norm(), std::abs(axis.z()));
}

}  // namespace omnitag
