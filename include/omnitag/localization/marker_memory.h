#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/localization/observation.h"

namespace omnitag {

/// What a frame looks at beside the markers that it expects to see.
struct AttentionConfig {
  /// s, in which views all around are looked at with the decoder for what is not expected, one
  /// after another.
  double period = 2.0;
  /// Pixels of one of these views, at most; larger ones are made coarser. 30 ns each, on a
  /// processor of 2020.
  int max_pixels = 40000;
  /// m and s: a marker that was looked for in vain twice, as behind a wall, is looked for again
  /// where the camera has come so far, or so much later.
  double hidden_way = 0.25;
  double hidden_time = 1.0;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
AttentionConfig readAttentionConfig(const YamlReader& reader);

/// A marker as an image showed it, and from where.
struct RememberedSighting {
  /// s.
  double stamp = 0.0;
  MarkerObservation observation;
  /// With the error that the image's camera seemed to have.
  MountedCamera camera;
  Pose map_from_base;
};

/// Markers that hang elsewhere than the map says, all by the same motion.
struct DisplacedGroup {
  std::vector<std::size_t> entries;
  /// Takes the poses to those from which they would hang in their places; none where it is not
  /// known.
  std::optional<Eigen::Isometry3d> motion;
};

/// Which markers of the map the images before showed, in their places or elsewhere, and which they
/// did not although they were in view, according to one hypothesis of the robot's poses.
class MarkerMemory {
 public:
  explicit MarkerMemory(const AttentionConfig& config) : config_(config) {}

  /// A marker in its place, from the pose of its frame.
  void addSeen(const RememberedSighting& sighting);
  /// `viewpoint`: the camera's place in the map.
  void addMissed(std::size_t entry, const Eigen::Vector3d& viewpoint, double stamp);
  /// One that was missed where no marker tells that the pose is right.
  void addLost(std::size_t entry);

  /// Whether something hides a marker, most likely, so that it need not be looked for.
  bool isHidden(std::size_t entry, const Eigen::Vector3d& viewpoint, double stamp) const;

  /// Whether it was seen, or missed, when it was looked for the last time.
  bool wasSeen(std::size_t entry) const;
  bool wasMissed(std::size_t entry) const;

  /// Of the markers that were looked for the first time, the share that was seen; between 0.1 and
  /// 0.9.
  double seenAtFirst() const;

  /// Whether the image at a stamp showed it, or one since.
  bool wasSeenSince(std::size_t entry, double stamp) const;

  /// When a marker was last seen in its place, and since then elsewhere; null where it was not.
  const RememberedSighting* inPlace(std::size_t entry) const;
  const RememberedSighting* elsewhere(std::size_t entry) const;
  /// In how many images it was, one after another.
  int timesInPlace(std::size_t entry) const { return records_[entry].times_in_place; }
  /// s: the stamp at which it then was first seen elsewhere.
  double elsewhereSince(std::size_t entry) const { return records_[entry].elsewhere_since; }
  bool isElsewhere(std::size_t entry) const { return elsewhere(entry) != nullptr; }
  /// Whether any marker does.
  bool hasElsewhere() const;
  /// How many were seen in their places, and not elsewhere since.
  std::size_t countInPlace() const;

  /// Whether a marker, as it was seen, was not where a pose would have it that is moved in the map.
  using Contradicts = std::function<bool(const RememberedSighting&, const Eigen::Isometry3d&)>;

  /// Markers that were seen elsewhere in one image, all of which would hang in their places if the
  /// hypothesis' pose were moved in the map: as one group, that of before if there is one.
  /// `motion`: none where it is not known.
  void addGroup(const std::vector<RememberedSighting>& sightings,
                const std::optional<Eigen::Isometry3d>& motion);
  /// One of which only that is known: of a group by whose motion it may hang there, or alone.
  void addElsewhere(const RememberedSighting& sighting, const Contradicts& contradicts);
  std::vector<DisplacedGroup> displacedGroups() const;
  /// Takes all poses so far for wrong by a motion in the map: what was seen in its place may have
  /// been elsewhere then, and the other way round.
  void moveBy(const Eigen::Isometry3d& motion, const Contradicts& contradicts);

  /// Takes what another memory knows. `entries`: for each marker of this one's map, which of the
  /// other's map it is; none where it is none, or hangs elsewhere.
  void takeFrom(const MarkerMemory& before, const std::vector<std::optional<std::size_t>>& entries);

  void clear();
  /// Forgets where markers were seen, which a pose told that was wrong, but not which are hidden.
  void forgetPlaces();

 private:
  static constexpr double kNever = -1e300;
  struct Record {
    double seen = kNever;
    double missed = kNever;
    Eigen::Vector3d missed_from = Eigen::Vector3d::Zero();
    /// Since it was seen.
    int misses = 0;
    std::optional<RememberedSighting> in_place;
    std::optional<RememberedSighting> elsewhere;
    int times_in_place = 0;
    /// Since when, and of which group.
    double elsewhere_since = 0.0;
    std::size_t group = 0;
  };
  Record& of(std::size_t entry);
  void addElsewhere(const RememberedSighting& sighting, std::size_t group);
  std::size_t newGroup(const std::optional<Eigen::Isometry3d>& motion);
  void addFirst(const Record& record, bool is_seen);

  AttentionConfig config_;
  double first_looks_ = 0.0;
  double first_seen_ = 0.0;
  /// By map entry; as many as were looked for.
  std::vector<Record> records_;
  /// Of each group: takes the poses to those from which its markers hang in their places.
  std::vector<std::optional<Eigen::Isometry3d>> groups_;
};

}  // namespace omnitag
