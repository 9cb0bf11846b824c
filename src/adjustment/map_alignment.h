#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/common/pose.h"

namespace omnitag {

/// The robot's pose at one time, in the map that was built and in the map of another localizer.
struct PosePair {
  Pose in_map;
  Pose in_other;
};

/// A point in the map that was built and, measured by hand, in another map (m).
struct PointPair {
  Eigen::Vector2d in_map;
  Eigen::Vector2d in_other;
};

/// The planar transform from the map that was built to another map; z is along gravity in both.
struct MapAlignment {
  Pose other_from_map;
  /// Covariance of its errors in x, y and yaw, about the middle of what was aligned (m and rad).
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// RMS of the residuals of the pairs that agree: m, and rad if there are headings.
  double position_residual = 0.0;
  double heading_residual = 0.0;
  /// Number of pairs that agree, and of all pairs.
  std::size_t agreeing = 0;
  std::size_t all = 0;

  /// Standard deviations of the fit, in m and rad.
  double positionDeviation() const;
  double headingDeviation() const;
};

/// Robust: poses of a localizer that was lost for a while do not count. The errors of successive
/// poses are correlated, so the deviations are those of the equivalent number of independent poses.
/// Throws InputError for fewer than three pairs, or if most do not agree.
MapAlignment alignByPoses(const std::vector<PosePair>& pairs);

/// From two or more points, all of which count; with two, the deviations follow from how much the
/// distances between them differ. Throws InputError for fewer points, or if all are less than half
/// a metre apart.
MapAlignment alignByPoints(const std::vector<PointPair>& pairs);

}  // namespace omnitag
