#pragma once

#include <Eigen/Core>
#include <cstddef>
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

/// Which markers of the map the images before showed, and which they did not though a pose had them
/// in view.
class MarkerMemory {
 public:
  explicit MarkerMemory(const AttentionConfig& config) : config_(config) {}

  /// Of the frame at a stamp (s); before anything is added of it.
  void startFrame(double stamp) { stamp_ = stamp; }
  double stamp() const { return stamp_; }

  /// A marker in its place, as the pose of its frame has it.
  void addSeen(const RememberedSighting& sighting);
  /// One that hangs elsewhere than the map says, if the pose of its frame is right; `is_certain`:
  /// whether it is.
  void addElsewhere(const RememberedSighting& sighting, bool is_certain);
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

  /// Whether the marker hangs elsewhere for certain.
  bool isElsewhere(std::size_t entry) const;
  /// How many were seen in their places.
  std::size_t countInPlace() const;

  /// Entries from here on were never looked for.
  std::size_t size() const { return records_.size(); }

  /// Takes what another memory knows. `entries`: for each marker of this one's map, which of the
  /// other's map it is; none where it is none, or hangs elsewhere.
  void takeFrom(const MarkerMemory& before, const std::vector<std::optional<std::size_t>>& entries);

  void clear() { records_.clear(); }
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
    bool is_certain = false;
  };
  Record& of(std::size_t entry);
  void addFirst(const Record& record, bool is_seen);

  AttentionConfig config_;
  double stamp_ = 0.0;
  double first_looks_ = 0.0;
  double first_seen_ = 0.0;
  /// By map entry; as many as were looked for.
  std::vector<Record> records_;
};

}  // namespace omnitag
