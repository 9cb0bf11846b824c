#pragma once

#include <Eigen/Core>

#include "omnitag/camera/shutter_config.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// How the base moves while an image is taken, and how well that is known.
struct BaseMotion {
  /// Per second, along and about the axes of base_link; in a PoseVector's order.
  PoseVector velocity = PoseVector::Zero();
  /// m/s and rad/s: standard deviations of the velocity along x and y and of the yaw rate, which
  /// the image itself may determine better.
  Eigen::Vector3d deviations = Eigen::Vector3d::Zero();

  /// The pose of base_link after this many seconds, in base_link at the stamp.
  Eigen::Isometry3d after(double time) const;
};

/// The velocity, as in BaseMotion, of a motion that takes this many seconds.
PoseVector velocityOf(const Eigen::Isometry3d& motion, double duration);

}  // namespace omnitag
