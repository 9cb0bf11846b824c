#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/observation.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/attention_config.h"

namespace omnitag {

/// A marker as an image showed it, and from where.
struct RememberedSighting {
  /// s.
  double stamp = 0.0;
  MarkerObservation observation;
  /// With the imaging error estimated for the image.
  MountedCamera camera;
  Pose map_from_base;
};

/// Markers that hang elsewhere than the map says, all by the same motion.
struct DisplacedGroup {
  std::vector<std::size_t> entries;
  /// Moves the poses to where the markers would be seen in their places; none if not known.
  std::optional<Eigen::Isometry3d> motion;
};

/// Which markers of the map earlier images showed, in their places or elsewhere, and which they
/// failed to show although in view, according to one hypothesis of the robot's poses. Seen or
/// missed is remembered for each camera; where markers hang, for all cameras together.
class MarkerMemory {
 public:
  explicit MarkerMemory(const AttentionConfig& config) : config_(config) {}

  /// Sets the camera whose images the following calls are about.
  void lookThrough(std::size_t camera) { camera_ = camera; }

  /// Adds a marker in its place, seen from the pose of its frame.
  void addSeen(const RememberedSighting& sighting);
  /// `viewpoint`: the camera's place in the map.
  void addMissed(std::size_t entry, const Eigen::Vector3d& viewpoint, double stamp);
  /// Adds a marker that was missed in a frame whose pose no marker confirms.
  void addLost(std::size_t entry);

  /// Whether a marker is most likely hidden, so that it need not be looked for.
  bool isHidden(std::size_t entry, const Eigen::Vector3d& viewpoint, double stamp) const;

  /// Whether the marker was seen, or missed, when last looked for.
  bool wasSeen(std::size_t entry) const;
  bool wasMissed(std::size_t entry) const;

  /// The share of markers that were seen when first looked for; between 0.1 and 0.9.
  double seenAtFirst() const;

  /// Whether an image at this stamp or later showed it.
  bool wasSeenSince(std::size_t entry, double stamp) const;

  /// The last sighting of a marker in its place; and the last one elsewhere, if it was seen there
  /// since. Null if there is none.
  const RememberedSighting* inPlace(std::size_t entry) const;
  const RememberedSighting* elsewhere(std::size_t entry) const;
  /// In how many consecutive images it was in its place.
  int timesInPlace(std::size_t entry) const { return records_[entry].times_in_place; }
  /// s: the stamp at which it was first seen elsewhere.
  double elsewhereSince(std::size_t entry) const { return records_[entry].elsewhere_since; }
  bool isElsewhere(std::size_t entry) const { return elsewhere(entry) != nullptr; }
  /// Whether any marker was seen elsewhere.
  bool hasElsewhere() const;
  /// How many were seen in their places and not elsewhere since.
  std::size_t countInPlace() const;

  /// Whether the marker is out of its place in a sighting once the sighting's pose is moved in the
  /// map by a motion.
  using Contradicts = std::function<bool(const RememberedSighting&, const Eigen::Isometry3d&)>;

  /// Adds markers that one image showed elsewhere, and that would all be in their places if the
  /// hypothesis' pose were moved in the map. They form one group, the earlier one if there is one.
  /// `motion`: none if not known.
  void addGroup(const std::vector<RememberedSighting>& sightings,
                const std::optional<Eigen::Isometry3d>& motion);
  /// Adds a marker only known to be elsewhere: to a group whose motion may explain it, or alone.
  void addElsewhere(const RememberedSighting& sighting, const Contradicts& contradicts);
  std::vector<DisplacedGroup> displacedGroups() const;
  /// Treats all poses so far as wrong by a motion in the map: what was seen in its place may have
  /// been elsewhere, and the other way round.
  void moveBy(const Eigen::Isometry3d& motion, const Contradicts& contradicts);

  /// Takes over another memory. `entries`: for each marker of this map, the same marker in the
  /// other map; none if the other map lacks it or has it elsewhere.
  void takeFrom(const MarkerMemory& before, const std::vector<std::optional<std::size_t>>& entries);

  void clear();
  /// Forgets where markers were seen, because the pose was wrong, but not which are hidden.
  void forgetPlaces();

 private:
  static constexpr double kNever = -1e300;
  /// What came of looking for a marker with one camera.
  struct Looks {
    double seen = kNever;
    double missed = kNever;
    Eigen::Vector3d missed_from = Eigen::Vector3d::Zero();
    /// Since it was last seen.
    int misses = 0;
  };
  struct Record {
    /// By camera; only up to the last camera that looked for it.
    std::vector<Looks> looks;
    std::optional<RememberedSighting> in_place;
    std::optional<RememberedSighting> elsewhere;
    int times_in_place = 0;
    /// s: the stamp since when it has been elsewhere; and its group.
    double elsewhere_since = 0.0;
    std::size_t group = 0;
  };
  Record& of(std::size_t entry);
  /// The looks of the current camera.
  Looks& looksOf(std::size_t entry);
  const Looks& looksAt(std::size_t entry) const;
  void addElsewhere(const RememberedSighting& sighting, std::size_t group);
  std::size_t newGroup(const std::optional<Eigen::Isometry3d>& motion);
  void addFirst(const Looks& looks, bool is_seen);

  AttentionConfig config_;
  std::size_t camera_ = 0;
  double first_looks_ = 0.0;
  double first_seen_ = 0.0;
  /// By map entry; only up to the last one that was looked for.
  std::vector<Record> records_;
  /// For each group: moves the poses to where its markers would be seen in their places.
  std::vector<std::optional<Eigen::Isometry3d>> groups_;
};

}  // namespace omnitag
