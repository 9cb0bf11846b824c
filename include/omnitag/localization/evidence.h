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
  double together = 3.0;
  /// That a pose from outside is off by however much more than its deviations say, and that a pose
  /// is wrong on which several markers agreed.
  double mistaken_start = 0.2;
  double mistaken = 1e-2;
  /// That a marker is not found though it was seen when it was last looked for, and a pose has it
  /// in view. (Of others, how many of the map's were seen at first sight tells.)
  double missed = 0.03;
  /// How many times likelier one of two poses must be for the other one to be given up.
  double odds = 100.0;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
EvidenceConfig readEvidenceConfig(const YamlReader& reader);

/// A frame whose markers lead to another pose than was expected.
struct Contradiction {
  /// Without its markers; the pose that others of them stand for; and the one in question.
  Pose predicted;
  Pose expected;
  Pose found;
  /// Entries of the map that were seen where the found pose has them and the expected one has not,
  /// and the other way round.
  std::vector<std::size_t> for_found;
  std::vector<std::size_t> for_expected;
  /// Those that the expected pose has in view, and that were looked for there in vain.
  std::vector<std::size_t> missed;
  bool has_odometry = false;
};

enum class Verdict {
  kExpected,  ///< what is seen elsewhere was moved
  kFound,     ///< the robot was moved, or never where it was expected
  kOpen,      ///< neither is that much likelier
};

/// Weighs what a map, what images before showed, and a frame say for and against poses.
class Evidence {
 public:
  /// All but `config` must outlive it.
  Evidence(const EvidenceConfig& config, const MarkerMap& map, const MarkerMemory& memory,
           const ReprojectionConfig& reprojection, double max_misfit)
      : config_(config),
        map_(map),
        memory_(memory),
        reprojection_(reprojection),
        max_misfit_(max_misfit) {}

  /// Neighbours that are moved share the probability of one, so that a shelf counts once; markers
  /// that the images before showed in place hardly move, so that where these shift together the
  /// robot did. `start`: the prior that the poses since then go back to; none where markers told
  /// the first.
  Verdict weigh(const Contradiction& contradiction, const std::optional<PosePrior>& start) const;

 private:
  /// Natural logarithm of how many times likelier the expected pose is than that the robot was
  /// carried since the image before, and than that it never was where it is expected.
  double leadSinceThen(const Contradiction& contradiction, const Eigen::Isometry3d& motion) const;
  double leadAllAlong(const Contradiction& contradiction, const Eigen::Isometry3d& motion,
                      const std::optional<PosePrior>& start) const;
  /// Natural logarithm of the probability that these markers hang elsewhere, all by the motion that
  /// takes the expected pose to the found one.
  double logOfMoved(const std::vector<std::size_t>& entries, const Eigen::Isometry3d& motion) const;
  /// The same that markers are not found which the expected pose has in view: those that were seen
  /// the last time, or those that never were.
  double logOfMissed(const std::vector<std::size_t>& entries, bool were_seen) const;
  /// The same that the first pose was off by a motion; `is_met`: markers are seen where it has
  /// them.
  double logOfStart(const PosePrior& start, const Eigen::Isometry3d& motion, bool is_met) const;
  /// Whether a marker, as it was seen, was not where a pose moved like this has it.
  bool contradicts(const RememberedSighting& sighting, const Eigen::Isometry3d& motion) const;

  EvidenceConfig config_;
  const MarkerMap& map_;
  const MarkerMemory& memory_;
  const ReprojectionConfig& reprojection_;
  double max_misfit_;
};

}  // namespace omnitag
