#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/localization/pose_estimator.h"
#include "omnitag/localization/relocalization_config.h"
#include "omnitag/localization/reprojection.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_reader.h"

namespace omnitag {

/// What relocalize() is asked; `candidates` as candidatesOf() tells them.
struct RelocalizationProblem {
  const MarkerMap& map;
  const MountedCamera& camera;
  const std::vector<MarkerReading>& readings;
  const PosePrior& standing;
  const EstimatorConfig& estimation;
  const RelocalizationConfig& config;
  /// For each reading the entries that it may be.
  std::vector<std::vector<std::size_t>> candidates;

  MarkerObservation observation(std::size_t reading, std::size_t entry) const;
};

std::vector<std::vector<std::size_t>> candidatesOf(const std::vector<MarkerReading>& readings,
                                                   const MarkerMap& map);

/// A pose and the readings that it explains.
struct PoseHypothesis {
  ReprojectionFit fit;
  /// For each reading the entry that it is taken for, and its misfit (NaN without one).
  std::vector<std::optional<std::size_t>> entries;
  std::vector<Misfit> misfits;
  std::size_t explained = 0;
  /// Negative logarithm of the likelihood of the explained readings, but for a constant.
  double cost = 0.0;
  /// The same over all readings, each counting for at most as much as an unexplained one: what
  /// ranks hypotheses, since a pose between two that fit well explains more, and each badly.
  double saturated_cost = 0.0;
};

/// What a reading adds to a hypothesis' cost that is so far off.
double costOf(const Misfit& misfit);

/// All poses worth comparing, the best first: those that it does not clearly surpass.
std::vector<PoseHypothesis> poseHypotheses(const RelocalizationProblem& problem);

}  // namespace omnitag
