#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "omnitag/common/pose.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/localization/marker_memory.h"
#include "omnitag/localization/reprojection.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/measurement/pose_prior.h"

namespace omnitag {

/// How likely it is that the world is not as expected: the probabilities that weigh contradictory
/// poses against each other. They were chosen in the study of moved groups (group_study).
struct EvidenceConfig {
  /// That something moves the robot between two images without its odometry noticing; and the same
  /// without odometry, when the robot itself may have moved unexpectedly.
  double carried = 1e-6;
  double carried_without_odometry = 1e-2;
  /// That a marker is measured beside its place, for example because something covers part of it.
  double misread = 0.05;
  /// That markers hang elsewhere than the map says, by more than their deviation.
  double moved = 1e-2;
  /// 1/s: that a marker that was seen in its place is moved.
  double moved_per_second = 1e-8;
  /// m: the distance over which the probability that neighbours are moved together falls by a
  /// factor of e.
  double together = 2.5;
  /// That a pose from outside is off by more than its deviations, however much; and that markers
  /// then appear by chance where it puts them.
  double mistaken_start = 0.01;
  double mistaken = 1e-2;
  /// That a marker in view of a pose is not found, though it was when last looked for. For other
  /// markers, the share of the map's markers that were found at the first attempt is used.
  double missed = 0.03;
  /// Standard deviations (Misfit): the most that a marker in its place is off, if the pose is
  /// known.
  double in_place = 2.5;
  /// A hypothesis is dropped when another is this many times likelier.
  double odds = 100.0;
  /// The same between two that a pose from outside leaves open: only the sizes of two groups then
  /// tell which of them was moved. At 100, one marker in its place loses against five that were
  /// moved as one, and the pose is wrong by as much as they were moved (group_study).
  double odds_at_start = 1e4;
  /// m: while two hypotheses are possible, the likelier one is published with a covariance that
  /// covers the other, unless its deviation is then larger than this.
  double open_deviation = 0.25;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
EvidenceConfig readEvidenceConfig(const YamlReader& reader);

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
