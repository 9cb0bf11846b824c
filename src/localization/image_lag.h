#pragma once

#include <optional>

#include "omnitag/common/pose.h"

namespace omnitag {

/// Estimates from images and odometry whether images show the robot later than their stamps say.
///
/// If an image is late by tau, a turning robot appears turned further by tau times its turn rate,
/// so the turn from image to image differs from odometry's by tau times the change of that rate.
/// The lag is a linear regression over the last few hundred images.
class ImageLag {
 public:
  /// Adds an image: the yaw of the estimated pose minus the predicted one (rad), and the velocity
  /// by odometry (BaseMotion::velocity). `is_carried_on`: whether odometry carried the prediction
  /// on from the previous image.
  void add(double yaw_innovation, const PoseVector& velocity, bool is_carried_on);

  /// s; nothing unless there certainly is a lag.
  std::optional<double> lag() const;

 private:
  std::optional<double> last_turn_rate_;
  /// Sums over the images, weighted less the older they are: of 1, and of products of the change of
  /// the turn rate and the innovation.
  double count_ = 0.0;
  double rate_rate_ = 0.0;
  double rate_innovation_ = 0.0;
  double innovation_innovation_ = 0.0;
};

/// What a lag adds to the covariance of a pose: the robot's motion during the lag, and the apparent
/// displacement of markers from row to row while it turns.
PoseMatrix covarianceOfLag(double lag, const PoseVector& velocity);

}  // namespace omnitag
