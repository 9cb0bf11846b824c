#include "omnitag/calibration/leaning_mounting.h"

#include <cmath>
#include <string>

#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

Eigen::Matrix3d rotationOf(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (angle == 0.0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix();
}

}  // namespace

LeaningMounting::LeaningMounting(const Eigen::Isometry3d& base_from_camera)
    : position_(base_from_camera.translation().head<2>()) {
  const Eigen::Vector3d axis = base_from_camera.linear().col(2);
  const Eigen::Vector3d vertical(0.0, 0.0, axis.z() > 0.0 ? 1.0 : -1.0);
  const double lean = std::atan2(axis.head<2>().norm(), std::abs(axis.z()));
  if (lean > radians(45.0)) {
    throw InputError(
        "mounting: expected an optical axis near the vertical, found one that leans by " +
        std::to_string(std::lround(degrees(lean))) + " degrees");
  }
  // The shortest turn from the vertical to the axis is about a horizontal line.
  const Eigen::Vector3d turn = vertical.cross(axis);
  const Eigen::Vector3d rotation_vector =
      turn.norm() > 0.0 ? Eigen::Vector3d(lean / turn.norm() * turn) : Eigen::Vector3d::Zero();
  values_ = {base_from_camera.translation().z(), rotation_vector.x(), rotation_vector.y()};
  upright_ = rotationOf(rotation_vector).transpose() * base_from_camera.linear();
}

Eigen::Isometry3d LeaningMounting::at(const Values& values) const {
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
  base_from_camera.linear() = rotationOf({values.y(), values.z(), 0.0}) * upright_;
  base_from_camera.translation() = Eigen::Vector3d(position_.x(), position_.y(), values.x());
  return base_from_camera;
}

}  // namespace omnitag
