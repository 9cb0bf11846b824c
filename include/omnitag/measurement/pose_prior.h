#pragma once

#include "omnitag/common/pose.h"

namespace omnitag {

/// What is known of a frame's pose before its markers are looked at: all of it where there is a
/// prediction, how a floor lets a robot lean where there is none, or nothing.
struct PosePrior {
  Pose pose;
  /// Inverse covariance of the pose's error (a PoseVector); zero along what is not known.
  PoseMatrix information = PoseMatrix::Zero();
  /// The part of the covariance by which the images before erred as this one does, since they share
  /// the map and the camera: see estimateOf().
  PoseMatrix shared = PoseMatrix::Zero();
  /// Whether it tells of x, y and yaw at all.
  bool knows_place = false;

  /// A pose that is known with its covariance.
  static PosePrior about(const PoseEstimate& estimate);

  /// Nothing of x, y and yaw; z, roll and pitch from `lean` (its x, y and yaw are not looked
  /// at), with these standard deviations (m and rad).
  static PosePrior standing(const Pose& lean, double height_deviation, double lean_deviation);

  /// The same on a floor that is exactly even, under a robot that stands exactly upright.
  static PosePrior upright();

  /// One that knows nothing of x, y and yaw, with what is known of them.
  PosePrior withPlace(const Pose& place, const Eigen::Matrix3d& place_information) const;

  /// The same of a robot that something has moved by about so much (standard deviations of a
  /// PoseVector), unknown to its odometry. It must know all six.
  PosePrior pushed(const PoseVector& deviations) const;

  /// Of a prior that knows all six.
  PoseMatrix covariance() const;

  /// The same without anything of x, y and yaw.
  PosePrior withoutPlace() const;

  /// Whether it tells anything of z, roll and pitch.
  bool knowsStanding() const;

  /// By how much a pose is off.
  PoseVector errorOf(const Pose& other) const;
};

}  // namespace omnitag
