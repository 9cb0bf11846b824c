#pragma once

#include <random>

#include "omnitag/common/angle.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// A prediction that is off by these standard deviations (m and rad) of each coordinate and of the
/// heading, and says so.
inline PoseEstimate drawnPrediction(const Pose& truth, double position_deviation,
                                    double heading_deviation, std::mt19937* generator) {
  std::normal_distribution<double> position(0.0, position_deviation);
  std::normal_distribution<double> heading(0.0, heading_deviation);
  const double x = truth.x + position(*generator);
  const double y = truth.y + position(*generator);
  const double yaw = truth.yaw + heading(*generator);
  return floorEstimate({x, y, yaw},
                       Eigen::Vector3d(position_deviation, position_deviation, heading_deviation)
                           .cwiseAbs2()
                           .asDiagonal());
}

/// As a robot in motion has it: off by 2 cm and 0.5 degrees.
inline PoseEstimate goodPrediction(const Pose& truth, std::mt19937* generator) {
  return drawnPrediction(truth, 0.02, radians(0.5), generator);
}

}  // namespace omnitag
