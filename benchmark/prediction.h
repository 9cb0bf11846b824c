#pragma once

#include <random>

#include "omnitag/common/angle.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// A prediction of a pose as a robot in motion has it: off by 2 cm and 0.5 degrees (standard
/// deviations), and it says so.
inline PoseEstimate goodPrediction(const Pose& truth, std::mt19937* generator) {
  constexpr double kPositionDeviation = 0.02;
  const double heading_deviation = radians(0.5);
  std::normal_distribution<double> position(0.0, kPositionDeviation);
  std::normal_distribution<double> heading(0.0, heading_deviation);
  PoseEstimate predicted;
  predicted.pose.x = truth.x + position(*generator);
  predicted.pose.y = truth.y + position(*generator);
  predicted.pose.yaw = truth.yaw + heading(*generator);
  predicted.covariance.diagonal().head<3>() << kPositionDeviation * kPositionDeviation,
      kPositionDeviation * kPositionDeviation, heading_deviation * heading_deviation;
  return predicted;
}

}  // namespace omnitag
