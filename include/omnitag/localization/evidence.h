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

/// How likely it is that the world is not as expected: all probabilities that weigh contradictory
/// poses against each other. They were chosen in the study of moved groups (group_study).
struct EvidenceConfig {
  /// That something moves the robot between two images without its odometry noticing; and the same
  /// without odometry, when the robot may also have moved differently by itself.
  double carried = 1e-6;
  double carried_without_odometry = 1e-2;
  /// That a marker is measured beside its place, for example because something covers part of it.
  double misread = 0.05;
  /// That markers hang elsewhere than the map says, by more than their deviation.
  double moved = 1e-2;
  /// 1/s: that a marker that was seen in its place is moved.
  double moved_per_second = 1e-8;
  /// m, over which the probability that neighbours are moved together falls by a factor of e.
  double together = 2.5;
  /// That a pose from outside is off by any amount beyond its deviations; and that markers are seen
  /// by chance where it puts them.
  double mistaken_start = 0.01;
  double mistaken = 1e-2;
  /// That a marker is not found though it was found when last looked for, and is in view of a pose.
  /// For other markers, the share of the map's markers that were found at first sight counts.
  double missed = 0.03;
  /// Standard deviations (Misfit) by which a marker in its place is off at most, if the pose
  /// is known.
  double in_place = 2.5;
  /// How many times likelier than another a hypothesis must be for the other to be given up.
  double odds = 100.0;
  /// The same between two that a pose from outside leaves open: which of two groups was moved then
  /// rests on their sizes alone. With 100, one marker in its place against five that were moved as
  /// one is given up, and the pose is as wrong as they are far (group_study).
  double odds_at_start = 1e4;
  /// m: while two hypotheses are possible, the likelier one is published with a covariance that
  /// covers the other, unless its deviation is then larger than this.
  double open_deviation = 0.25;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
EvidenceConfig readEvidenceConfig(const YamlReader& reader);

/// By how many standard deviations a pose from outside was off, if it was off by this motion in
/// the map.
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
  /// are seen where that pose puts them, which is chance if it was off.
  double logOfStart(const PosePrior& start, const Eigen::Isometry3d& motion, bool is_met) const;

  /// The same for the robot having been carried since the last image.
  double logOfCarried(bool has_odometry) const;

  /// Whether the marker was not in its place in a sighting whose pose is moved in the map
  /// by `motion`.
  bool contradicts(const RememberedSighting& sighting, const Eigen::Isometry3d& motion) const;
  /// The same as a function; valid during the lifetime of the evidence.
  MarkerMemory::Contradicts contradiction() const;

 private:
  double logOfMoved(const DisplacedGroup& group, const MarkerMemory& memory) const;

  EvidenceConfig config_;
  const MarkerMap& map_;
  const ReprojectionConfig& reprojection_;
};

}  // namespace omnitag
