#pragma once

#include <cstddef>
#include <vector>

#include "localization/marker_memory.h"
#include "localization/reprojection.h"
#include "measurement/pose_prior.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/evidence_config.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How many standard deviations a pose from outside was off, if this motion in the map corrects it.
double deviationsOfStart(const PosePrior& start, const Eigen::Isometry3d& motion);

/// Weighs hypotheses by the probability of everything that each has to assume.
class Evidence {
 public:
  /// All but `config` must outlive it.
  Evidence(const EvidenceConfig& config, const MarkerMap& map,
           const ReprojectionConfig& reprojection)
      : config_(config), map_(map), reprojection_(reprojection) {}

  const EvidenceConfig& config() const { return config_; }

  /// Natural logarithm of the probability that the markers are where a hypothesis saw them.
  /// Neighbours that are moved together share the probability of one, so that a shelf counts once.
  /// Markers that were in their places a moment ago are unlikely to have moved: if they shift
  /// together, the robot did.
  double logOfPlaces(const MarkerMemory& memory) const;

  /// The same for not finding markers that are in view of a pose. `memory`: as of earlier frames.
  double logOfMissed(const std::vector<std::size_t>& entries, const MarkerMemory& memory) const;

  /// The same for a pose from outside being off by a motion in the map. `is_met`: whether markers
  /// are seen where that pose puts them, which is a coincidence if it was off.
  double logOfStart(const PosePrior& start, const Eigen::Isometry3d& motion, bool is_met) const;

  /// The same for the robot having been carried since the last image.
  double logOfCarried(bool has_odometry) const;

  /// Whether the marker is out of its place in a sighting once the sighting's pose is moved in the
  /// map by `motion`.
  bool contradicts(const RememberedSighting& sighting, const Eigen::Isometry3d& motion) const;
  /// The same as a function, valid as long as this object lives.
  MarkerMemory::Contradicts contradiction() const;

 private:
  double logOfMoved(const DisplacedGroup& group, const MarkerMemory& memory) const;

  EvidenceConfig config_;
  const MarkerMap& map_;
  const ReprojectionConfig& reprojection_;
};

}  // namespace omnitag
