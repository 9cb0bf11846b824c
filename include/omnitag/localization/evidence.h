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

/// How likely it is that the world is not as expected: all probabilities by which poses that
/// contradict each other are weighed. The study of moved groups (group_study) set them.
struct EvidenceConfig {
  /// That something moves the robot from one image to the next that its odometry does not feel, and
  /// the same where there is none: then the robot may have moved otherwise by itself.
  double carried = 1e-6;
  double carried_without_odometry = 1e-2;
  /// That a marker is seen elsewhere than it hangs, as where something covers it in part.
  double misread = 0.05;
  /// That markers hang elsewhere than the map says, by more than their deviation.
  double moved = 1e-2;
  /// 1/s: that this happens to one that was seen in its place.
  double moved_per_second = 1e-8;
  /// m, by which neighbours are apart that are moved together only every e-th time.
  double together = 2.5;
  /// That a pose from outside is off by however much more than its deviations say, and that markers
  /// are seen where it has them by chance.
  double mistaken_start = 0.01;
  double mistaken = 1e-2;
  /// That a marker is not found though it was seen when it was last looked for, and a pose has it
  /// in view. (Of others, how many of the map's were seen at first sight tells.)
  double missed = 0.03;
  /// Standard deviations (Misfit) that a marker is off at most which hangs in its place, where the
  /// pose is known.
  double in_place = 2.5;
  /// How many times likelier one of two hypotheses must be for the other one to be given up.
  double odds = 100.0;
  /// m: as long as two are possible, the likelier one is published with a covariance that covers
  /// the other, unless its deviation is then larger.
  double open_deviation = 0.25;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
EvidenceConfig readEvidenceConfig(const YamlReader& reader);

/// By how many standard deviations a pose from outside was off, if by this motion in the map.
double deviationsOfStart(const PosePrior& start, const Eigen::Isometry3d& motion);

/// Weighs hypotheses: how likely it is that all happened which one of them has to suppose.
class Evidence {
 public:
  /// All but `config` must outlive it.
  Evidence(const EvidenceConfig& config, const MarkerMap& map,
           const ReprojectionConfig& reprojection)
      : config_(config), map_(map), reprojection_(reprojection) {}

  const EvidenceConfig& config() const { return config_; }

  /// Natural logarithm of the probability that the markers are where a hypothesis saw them.
  /// Neighbours that are moved together share the probability of one, so that a shelf counts once;
  /// markers that were in their places a moment ago hardly move, so that where these shift together
  /// the robot did.
  double logOfPlaces(const MarkerMemory& memory) const;

  /// The same that markers are not found which a pose has in view. `memory`: as of the frames
  /// before.
  double logOfMissed(const std::vector<std::size_t>& entries, const MarkerMemory& memory) const;

  /// The same that a pose from outside was off by a motion in the map. `is_met`: whether markers
  /// are seen where that pose has them; those that were moved are so only by chance.
  double logOfStart(const PosePrior& start, const Eigen::Isometry3d& motion, bool is_met) const;

  /// The same that the robot was carried since the image before.
  double logOfCarried(bool has_odometry) const;

  /// Whether a marker, as it was seen, was not where a pose has it that is moved in the map.
  bool contradicts(const RememberedSighting& sighting, const Eigen::Isometry3d& motion) const;
  /// The same as a function; valid as long as the evidence is.
  MarkerMemory::Contradicts contradiction() const;

 private:
  double logOfMoved(const DisplacedGroup& group, const MarkerMemory& memory) const;

  EvidenceConfig config_;
  const MarkerMap& map_;
  const ReprojectionConfig& reprojection_;
};

}  // namespace omnitag
