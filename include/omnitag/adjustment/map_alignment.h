#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/common/pose.h"

namespace omnitag {

/// The robot at one time, in the map that was built, and in that of another localizer.
struct PosePair {
  Pose in_map;
  Pose in_other;
};

/// A point of the map that was built, and where it is in another, by hand (m).
struct PointPair {
  Eigen::Vector2d in_map;
  Eigen::Vector2d in_other;
};

/// Where the map that was built lies in another, in the plane: z is along gravity in both.
struct MapAlignment {
  Pose other_from_map;
  /// Of x, y and yaw of a change of it, about the middle of what was aligned (m and rad).
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// What is left, RMS, over what agrees: m, and rad where there are headings.
  double position_residual = 0.0;
  double heading_residual = 0.0;
  /// Pairs that agree, and all.
  std::size_t agreeing = 0;
  std::size_t all = 0;

  /// m and rad: standard deviations of the fit.
  double positionDeviation() const;
  double headingDeviation() const;
};

/// Robust: a localizer that was lost for a while does not count there. Errors that last from one
/// pose to the next are counted once: the deviations are those of as many poses as are independent.
/// Throws InputError for fewer than three pairs, and where most do not agree.
MapAlignment alignByPoses(const std::vector<PosePair>& pairs);

/// Of two points or more, all of which count. Two say by how much their distances differ, from
/// which the deviations are. Throws InputError for fewer, or points nearer than half a metre.
MapAlignment alignByPoints(const std::vector<PointPair>& pairs);

}  // namespace omnitag
