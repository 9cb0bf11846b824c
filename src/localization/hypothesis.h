#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <optional>

#include "localization/evidence.h"
#include "localization/marker_memory.h"
#include "localization/motion_model.h"
#include "measurement/pose_prior.h"

namespace omnitag {

/// One history of where the robot has been, and of which markers hang elsewhere than the map says.
struct Hypothesis {
  MotionModel motion;
  MarkerMemory memory;
  /// The pose from outside that its poses derive from, none if markers gave the first one; and the
  /// motion in the map that corrects that pose.
  std::optional<PosePrior> start = std::nullopt;
  Eigen::Isometry3d start_error = Eigen::Isometry3d::Identity();
  /// Whether its pose became too uncertain to be carried on; the hypothesis may still be right.
  bool is_lost = false;
  /// Natural logarithm of the probability that something moved the robot unnoticed.
  double log_of_carried = 0.0;
  /// The same for what it had to assume about markers that are back in their places: the least
  /// likely return that a single image showed.
  double log_of_returned = 0.0;
  /// Stamp (s) of the last image whose markers gave its pose.
  double seen_stamp = std::numeric_limits<double>::infinity();

  /// From now on its poses derive from `pose`, or from markers if there is none.
  void restart(const std::optional<PosePrior>& pose);

  /// Whether its poses derive from a pose from outside, and lie within that pose's uncertainty.
  bool isWithinStart() const;

  /// Natural logarithm of its probability, up to a constant that all hypotheses share.
  double logProbability(const Evidence& evidence) const;
};

}  // namespace omnitag
