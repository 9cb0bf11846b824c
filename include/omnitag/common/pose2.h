#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace omnitag {

/// Pose of a robot that moves on the floor: position in metres, yaw in radians counter-clockwise.
/// As a transform it is target_from_source of the plane, e.g. `map_from_base`.
struct Pose2 {
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;

  /// The same pose in space: z = 0, roll = pitch = 0.
  Eigen::Isometry3d toIsometry() const;

  /// The floor's share of a pose in space: x, y and the heading of its x axis.
  static Pose2 fromIsometry(const Eigen::Isometry3d& pose);
};

/// a_from_c of a_from_b and b_from_c; the yaw is normalised.
Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c);

/// b_from_a of a_from_b.
Pose2 inverse(const Pose2& a_from_b);

/// A pose and how far it can be trusted: covariance of (x, y, yaw) in m^2, m rad and rad^2, in the
/// axes of the frame that the pose is expressed in.
struct PoseEstimate {
  Pose2 pose;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// m, standard deviation of the position: of both coordinates together.
double positionDeviation(const PoseEstimate& estimate);

/// a - b, its yaw normalised.
Eigen::Vector3d difference(const Pose2& a, const Pose2& b);

/// Whether two independent estimates of the same pose may both be right: their difference is within
/// what 999 of 1000 such pairs have (Mahalanobis distance, chi-square with 3 degrees of freedom).
bool agree(const PoseEstimate& a, const PoseEstimate& b);

}  // namespace omnitag
