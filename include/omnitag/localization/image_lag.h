#pragma once

#include <optional>

#include "omnitag/common/pose.h"

namespace omnitag {

/// Tells from the images and odometry whether images show the robot later than their stamps say.
///
/// An image that is late by tau shows a robot that turns by tau times its turn rate further, so
/// that the turn from image to image differs from odometry's by tau times the change of that rate:
/// linear regression over the last minutes.
class ImageLag {
 public:
  /// What an image told: the yaw of the pose that was found less the predicted one (rad), and the
  /// velocity by odometry (BaseMotion::velocity). `is_carried_on`: whether the prediction followed
  /// from the image before by odometry.
  void add(double yaw_innovation, const PoseVector& velocity, bool is_carried_on);

  /// s; nothing as long as it is not certain that there is one.
  std::optional<double> lag() const;

 private:
  std::optional<double> last_turn_rate_;
  /// Sums over the images, those long ago less: of 1, of products of the change of the turn rate
  /// and the innovation.
  double count_ = 0.0;
  double rate_rate_ = 0.0;
  double rate_innovation_ = 0.0;
  double innovation_innovation_ = 0.0;
};

/// What a lag adds to the covariance of a pose: the robot's way in this time, and a turn in it as
/// it displaces what is seen from row to row.
PoseMatrix covarianceOfLag(double lag, const PoseVector& velocity);

}  // namespace omnitag
