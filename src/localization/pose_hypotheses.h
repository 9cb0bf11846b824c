#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/pose_estimator.h"
#include "localization/reprojection.h"
#include "marker/marker_reader.h"
#include "omnitag/localization/relocalization_config.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The input of relocalize(), with `candidates` from candidatesOf().
struct RelocalizationProblem {
  const MarkerMap& map;
  const MountedCamera& camera;
  const std::vector<MarkerReading>& readings;
  const PosePrior& standing;
  const EstimatorConfig& estimation;
  const RelocalizationConfig& config;
  /// For each reading, the entries that it may be.
  std::vector<std::vector<std::size_t>> candidates;

  MarkerObservation observation(std::size_t reading, std::size_t entry) const;
};

std::vector<std::vector<std::size_t>> candidatesOf(const std::vector<MarkerReading>& readings,
                                                   const MarkerMap& map);

/// A pose and the readings that it explains.
struct PoseHypothesis {
  ReprojectionFit fit;
  /// For each reading, the associated entry and its misfit (NaN without one).
  std::vector<std::optional<std::size_t>> entries;
  std::vector<Misfit> misfits;
  std::size_t explained = 0;
  /// Negative logarithm of the likelihood of the explained readings, up to a constant.
  double cost = 0.0;
  /// The same over all readings, none counting more than an unexplained one. This ranks hypotheses,
  /// because a pose between two good ones explains more readings, but each badly.
  double saturated_cost = 0.0;
};

/// What a reading that is this far off adds to a hypothesis' cost.
double costOf(const Misfit& misfit);

/// All poses worth comparing, the best first: it does not clearly surpass the others.
std::vector<PoseHypothesis> poseHypotheses(const RelocalizationProblem& problem);

}  // namespace omnitag
