#include "omnitag/common/pose.h"

#include <cmath>

#include "common/rotation.h"
#include "common/symmetric_matrix.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

bool isLevel(const Pose& pose) { return pose.roll == 0.0 && pose.pitch == 0.0; }

}  // namespace

Eigen::Isometry3d Pose::toIsometry() const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << x, y, z;
  const double cy = std::cos(yaw);
  const double sy = std::sin(yaw);
  if (isLevel(*this)) {
    pose.linear() << cy, -sy, 0.0, sy, cy, 0.0, 0.0, 0.0, 1.0;
    return pose;
  }
  const double cp = std::cos(pitch);
  const double sp = std::sin(pitch);
  const double cr = std::cos(roll);
  const double sr = std::sin(roll);
  pose.linear() << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,               //
      -sp, cp * sr, cp * cr;
  return pose;
}

Pose Pose::fromIsometry(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d& rotation = pose.linear();
  const Eigen::Vector3d& place = pose.translation();
  return {place.x(),
          place.y(),
          std::atan2(rotation(1, 0), rotation(0, 0)),
          place.z(),
          std::atan2(rotation(2, 1), rotation(2, 2)),
          std::atan2(-rotation(2, 0), std::hypot(rotation(0, 0), rotation(1, 0)))};
}

Eigen::Vector3d translationPart(const PoseVector& change) {
  return {change[0], change[1], change[3]};
}

Eigen::Vector3d rotationPart(const PoseVector& change) { return {change[4], change[5], change[2]}; }

PoseVector poseVector(const Eigen::Vector3d& translation, const Eigen::Vector3d& rotation) {
  PoseVector change;
  change << translation.x(), translation.y(), rotation.z(), translation.z(), rotation.x(),
      rotation.y();
  return change;
}

PoseMatrix changeByMotion(const Eigen::Matrix3d& target_from_base) {
  PoseMatrix changes;
  for (int i = 0; i < 6; ++i) {
    const PoseVector unit = PoseVector::Unit(i);
    changes.col(i) = poseVector(target_from_base * translationPart(unit), rotationPart(unit));
  }
  return changes;
}

Pose moved(const Pose& pose, const PoseVector& change) {
  if (isLevel(pose) && change[4] == 0.0 && change[5] == 0.0) {
    return {pose.x + change[0], pose.y + change[1], normalizeAngle(pose.yaw + change[2]),
            pose.z + change[3]};
  }
  Eigen::Isometry3d isometry = pose.toIsometry();
  isometry.translation() += translationPart(change);
  isometry.linear() *= rotationOf(rotationPart(change));
  return Pose::fromIsometry(isometry);
}

PoseVector difference(const Pose& a, const Pose& b) {
  const Eigen::Vector3d translation(a.x - b.x, a.y - b.y, a.z - b.z);
  if (isLevel(a) && isLevel(b)) {
    return poseVector(translation, {0.0, 0.0, normalizeAngle(a.yaw - b.yaw)});
  }
  const Eigen::AngleAxisd turn(b.toIsometry().linear().transpose() * a.toIsometry().linear());
  return poseVector(translation, turn.angle() * turn.axis());
}

Pose operator*(const Pose& a_from_b, const Pose& b_from_c) {
  return Pose::fromIsometry(a_from_b.toIsometry() * b_from_c.toIsometry());
}

Pose inverse(const Pose& a_from_b) { return Pose::fromIsometry(a_from_b.toIsometry().inverse()); }

Pose leaningAs(const Pose& lean, const Pose& place) {
  return {place.x, place.y, place.yaw, lean.z, lean.roll, lean.pitch};
}

FloorMotionDerivatives floorMotionDerivatives(const Pose& from, const Pose& motion) {
  const double c = std::cos(from.yaw);
  const double s = std::sin(from.yaw);
  FloorMotionDerivatives derivatives;
  derivatives.by_from << -c, -s, motion.y, s, -c, -motion.x, 0.0, 0.0, -1.0;
  derivatives.by_to << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
  return derivatives;
}

PoseEstimate floorEstimate(const Pose& pose, const Eigen::Matrix3d& covariance) {
  PoseEstimate estimate{pose, PoseMatrix::Zero()};
  estimate.covariance.topLeftCorner<3, 3>() = covariance;
  return estimate;
}

Eigen::Matrix3d floorCovariance(const PoseEstimate& estimate) {
  return estimate.covariance.topLeftCorner<3, 3>();
}

double positionDeviation(const PoseEstimate& estimate) {
  return std::sqrt(estimate.covariance.topLeftCorner<2, 2>().trace());
}

bool agree(const PoseEstimate& a, const PoseEstimate& b) {
  constexpr double kLimit = 22.46;
  const PoseVector apart = difference(a.pose, b.pose);
  const PoseMatrix covariance = a.covariance + b.covariance;
  return mahalanobisSquare(apart, covariance) <= kLimit;
}

}  // namespace omnitag
