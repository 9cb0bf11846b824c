#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <optional>

#include "omnitag/localization/evidence.h"
#include "omnitag/localization/marker_memory.h"
#include "omnitag/localization/motion_model.h"
#include "omnitag/measurement/pose_prior.h"

namespace omnitag {

/// One account of where the robot has been, and of which markers hang elsewhere than the map says.
struct Hypothesis {
  MotionModel motion;
  MarkerMemory memory;
  /// The pose from outside that its poses go back to, none where markers told the first; and by
  /// which motion in the map that was off.
  std::optional<PosePrior> start = std::nullopt;
  Eigen::Isometry3d start_error = Eigen::Isometry3d::Identity();
  /// Whether its pose was too uncertain to be carried on; it may be right all the same.
  bool is_lost = false;
  /// Natural logarithm of the probability of what moved the robot unnoticed.
  double log_of_carried = 0.0;
  /// Stamp (s) of the last image whose markers told its pose.
  double seen_stamp = std::numeric_limits<double>::infinity();

  /// From now on its poses go back to `pose`, or to markers.
  void restart(const std::optional<PosePrior>& pose);

  /// Natural logarithm of its probability, up to what all hypotheses have in common.
  double logProbability(const Evidence& evidence) const;
};

}  // namespace omnitag
