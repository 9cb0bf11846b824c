#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace omnitag {

/// Rigid transform between a frame and a robot's base, e.g. `map_from_base`: position in metres;
/// orientation Rz(yaw) Ry(pitch) Rx(roll) in radians. On a floor z, roll and pitch are nearly zero.
struct Pose {
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;
  double z = 0.0;
  double roll = 0.0;
  double pitch = 0.0;

  Eigen::Isometry3d toIsometry() const;

  /// The yaw is the heading of the x axis.
  static Pose fromIsometry(const Eigen::Isometry3d& pose);

  /// The same place and heading with z = roll = pitch = 0.
  Pose onFloor() const { return {x, y, yaw}; }
};

/// A small change of a pose: translation along the axes of the target frame (m) and rotation about
/// the base's own axes (rad), in the order x, y, yaw, z, roll, pitch, so that the floor's part
/// comes first. Derivatives with respect to a pose, and its covariances, refer to such changes.
using PoseVector = Eigen::Matrix<double, 6, 1>;
using PoseMatrix = Eigen::Matrix<double, 6, 6>;

/// The translation (x, y, z) and the rotation (about x, y, z) of a change.
Eigen::Vector3d translationPart(const PoseVector& change);
Eigen::Vector3d rotationPart(const PoseVector& change);
PoseVector poseVector(const Eigen::Vector3d& translation, const Eigen::Vector3d& rotation);

/// Maps a small motion along and about the base's own axes, in a PoseVector's order, to the change
/// of the pose as above. `target_from_base`: the base's orientation.
PoseMatrix changeByMotion(const Eigen::Matrix3d& target_from_base);

/// The pose after a change.
Pose moved(const Pose& pose, const PoseVector& change);

/// The change that leads from `b` to `a`.
PoseVector difference(const Pose& a, const Pose& b);

/// a_from_c, from a_from_b and b_from_c.
Pose operator*(const Pose& a_from_b, const Pose& b_from_c);

/// b_from_a, from a_from_b.
Pose inverse(const Pose& a_from_b);

/// Derivatives of a motion on the floor, the (x, y, yaw) of `inverse(from) * to`, with respect to
/// the (x, y, yaw) of the poses at its beginning and its end.
struct FloorMotionDerivatives {
  Eigen::Matrix3d by_from;
  Eigen::Matrix3d by_to;
};

FloorMotionDerivatives floorMotionDerivatives(const Pose& from, const Pose& motion);

/// The place and heading of one pose with the height, roll and pitch of another.
Pose leaningAs(const Pose& lean, const Pose& place);

/// A pose and how far it can be trusted.
struct PoseEstimate {
  Pose pose;
  /// The covariance of a PoseVector.
  PoseMatrix covariance = PoseMatrix::Zero();
  /// The part of the covariance that is shared with estimates from other images of the same camera
  /// and map: averaging over them does not reduce it.
  PoseMatrix shared = PoseMatrix::Zero();
};

/// An estimate in which (x, y, yaw) has this covariance (m^2, m rad, rad^2) and the rest is exact.
PoseEstimate floorEstimate(const Pose& pose, const Eigen::Matrix3d& covariance);

/// Covariance of (x, y, yaw).
Eigen::Matrix3d floorCovariance(const PoseEstimate& estimate);

/// m, standard deviation of the position on the floor, of both coordinates together.
double positionDeviation(const PoseEstimate& estimate);

/// Whether two independent estimates of the same pose may both be right: their Mahalanobis distance
/// is one that 999 of 1000 such pairs stay within (chi-square with 6 degrees of freedom).
bool agree(const PoseEstimate& a, const PoseEstimate& b);

}  // namespace omnitag
