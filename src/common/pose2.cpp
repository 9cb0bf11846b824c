#include "omnitag/common/pose2.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "omnitag/common/angle.h"

namespace omnitag {

Eigen::Isometry3d Pose2::toIsometry() const {
  return Eigen::Translation3d(x, y, 0.0) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
}

Pose2 Pose2::fromIsometry(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d x_axis = pose.linear().col(0);
  return {pose.translation().x(), pose.translation().y(), std::atan2(x_axis.y(), x_axis.x())};
}

Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c) {
  const double c = std::cos(a_from_b.yaw);
  const double s = std::sin(a_from_b.yaw);
  return {a_from_b.x + c * b_from_c.x - s * b_from_c.y,
          a_from_b.y + s * b_from_c.x + c * b_from_c.y,
          normalizeAngle(a_from_b.yaw + b_from_c.yaw)};
}

Pose2 inverse(const Pose2& a_from_b) {
  const double c = std::cos(a_from_b.yaw);
  const double s = std::sin(a_from_b.yaw);
  return {-c * a_from_b.x - s * a_from_b.y, s * a_from_b.x - c * a_from_b.y,
          normalizeAngle(-a_from_b.yaw)};
}

double positionDeviation(const PoseEstimate& estimate) {
  return std::sqrt(estimate.covariance.topLeftCorner<2, 2>().trace());
}

Eigen::Vector3d difference(const Pose2& a, const Pose2& b) {
  return {a.x - b.x, a.y - b.y, normalizeAngle(a.yaw - b.yaw)};
}

bool agree(const PoseEstimate& a, const PoseEstimate& b) {
  constexpr double kLimit = 16.27;
  const Eigen::Vector3d d = difference(a.pose, b.pose);
  const Eigen::Matrix3d covariance = a.covariance + b.covariance;
  return d.dot(covariance.ldlt().solve(d)) <= kLimit;
}

}  // namespace omnitag
