#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include "omnitag/common/pose.h"

namespace omnitag {

/// Whether a position is wrong that is off by so much (x and y, m): by what its covariance does not
/// account for and a robot would notice.
inline bool isWrong(const PoseEstimate& estimate, const Eigen::Vector2d& offset) {
  constexpr double kDeviations = 5.0;
  constexpr double kNoticeable = 0.02;  // m
  const Eigen::Matrix2d covariance = estimate.covariance.topLeftCorner<2, 2>();
  return offset.norm() > kNoticeable &&
         offset.dot(covariance.inverse() * offset) > kDeviations * kDeviations;
}

}  // namespace omnitag
