#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "omnitag/common/yaml_reader.h"

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

/// Which markers of the map the images before showed, and which they did not though a pose had them
/// in view.
class MarkerMemory {
 public:
  explicit MarkerMemory(const AttentionConfig& config) : config_(config) {}

  void addSeen(std::size_t entry, double stamp);
  /// `viewpoint`: the camera's place in the map.
  void addMissed(std::size_t entry, const Eigen::Vector3d& viewpoint, double stamp);

  /// Whether something hides a marker, most likely, so that it need not be looked for.
  bool isHidden(std::size_t entry, const Eigen::Vector3d& viewpoint, double stamp) const;

  /// Whether it was seen when it was looked for the last time.
  bool wasSeen(std::size_t entry) const;

  /// Whether the image at a stamp showed it, or one since.
  bool wasSeenSince(std::size_t entry, double stamp) const;

  void clear() { records_.clear(); }

 private:
  struct Record {
    double seen = -1e300;
    double missed = -1e300;
    Eigen::Vector3d missed_from = Eigen::Vector3d::Zero();
    /// Since it was seen.
    int misses = 0;
  };
  Record& of(std::size_t entry);

  AttentionConfig config_;
  /// By map entry; as many as were looked for.
  std::vector<Record> records_;
};

}  // namespace omnitag
