#pragma once

#include "omnitag/common/pose.h"

namespace omnitag {

/// What is known of a frame's pose before its markers are considered: all of it with a prediction,
/// otherwise how a robot leans on a floor, or nothing.
struct PosePrior {
  Pose pose;
  /// Inverse covariance of the pose's error (a PoseVector); zero along unknown directions.
  PoseMatrix information = PoseMatrix::Zero();
  /// The part of the covariance that comes from errors that earlier images share with this one,
  /// those of the map and the camera: see estimateOf().
  PoseMatrix shared = PoseMatrix::Zero();
  /// Whether x, y and yaw are known at all.
  bool knows_place = false;

  /// A pose that is known with its covariance.
  static PosePrior about(const PoseEstimate& estimate);

  /// Knows z, roll and pitch from `lean`, with these standard deviations (m and rad), and nothing
  /// of x, y and yaw; those of `lean` are ignored.
  static PosePrior standing(const Pose& lean, double height_deviation, double lean_deviation);

  /// The same on an exactly even floor, for a robot that stands exactly upright.
  static PosePrior upright();

  /// This prior, which knows nothing of x, y and yaw, with these added.
  PosePrior withPlace(const Pose& place, const Eigen::Matrix3d& place_information) const;

  /// The prior after something moved the robot without its odometry noticing, by about this much
  /// (standard deviations of a PoseVector). All six numbers must be known.
  PosePrior pushed(const PoseVector& deviations) const;

  /// All six numbers must be known.
  PoseMatrix covariance() const;

  /// The prior without x, y and yaw.
  PosePrior withoutPlace() const;

  /// Whether anything is known of z, roll and pitch.
  bool knowsStanding() const;

  /// The error of a pose with respect to this prior.
  PoseVector errorOf(const Pose& other) const;
};

}  // namespace omnitag
