#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adjustment/marker_estimate.h"
#include "common/yaml_reader.h"
#include "omnitag/common/angle.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How a map is extended while the robot drives, and when an estimate is good enough.
struct MarkerMapperConfig {
  /// Effort spent on unknown markers in each frame, in views (LocalizerConfig::exploring_views).
  int views_per_frame = 2;
  /// Size of unknown markers in m; 0: the map's default size.
  double size = 0.0;
  /// Whether the sizes of unknown markers are estimated, starting from `size`.
  bool estimate_sizes = false;
  /// Pixels of the panorama, standard deviation of a decoded corner along each axis.
  double corner_noise = 0.1;
  /// m: sightings from a pose with a larger standard deviation are not used.
  double max_pose_deviation = 0.05;
  /// Largest number of sightings kept of a marker, and least distance between the places they were
  /// made from, in m.
  int max_sightings = 24;
  double min_step = 0.15;
  /// When a marker is used: least number of sightings, angle between the directions from which it
  /// was seen (rad), and share of sightings that agree; largest standard deviations in the worst
  /// direction (m and rad).
  int min_sightings = 4;
  double min_parallax = radians(15.0);
  double min_agreement = 0.8;
  double max_position_deviation = 0.02;
  double max_orientation_deviation = radians(1.5);
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
MarkerMapperConfig readMarkerMapperConfig(const YamlReader& reader);

/// A marker that the map did not have.
struct ProvisionalMarker {
  MarkerEstimate estimate;
  std::size_t sightings = 0;
  /// The largest angle between the directions from which it was seen, in rad.
  double parallax = 0.0;
  /// Whether the map has it.
  bool is_used = false;
};

/// Extends a map by markers that a localizer reads and the map does not have: keeps sightings of
/// each, estimates its place as the robot moves, and adds it to the map once the estimate is good
/// enough. Never changes the map's original markers.
///
/// Poses estimated from the mapper's own markers share the markers' errors: these markers'
/// uncertainty is added to the pose's in proportion to their share in it. Not thread-safe.
class MarkerMapper {
 public:
  /// Throws InputError if neither the configuration nor the map gives a size of unknown markers.
  MarkerMapper(CameraModels cameras, MarkerMap map, const MarkerMapperConfig& config);

  /// Processes a frame. Returns whether map() has changed.
  bool add(const Frame& frame, const FrameResult& result);

  /// The map's own markers followed by those that are good enough, whose indices stay the same.
  const MarkerMap& map() const { return map_; }

  /// The markers with an estimate, by family and id.
  std::vector<ProvisionalMarker> provisional() const;

  /// The estimated markers that are not good enough yet.
  std::vector<Marker> unfinished() const;

  /// Replaces the map's own markers, for example after markers were saved into the map. The
  /// mapper's markers that it does not have follow after them.
  void setOwn(MarkerMap own);

 private:
  using Key = std::pair<std::string, int>;
  struct Track {
    std::vector<MarkerSighting> sightings;
    std::optional<MarkerEstimate> estimate;
    /// Its index in map().
    std::optional<std::size_t> entry;
    /// Number of images in which the id was read at two places at once, so that it is not a single
    /// marker.
    int repetitions = 0;
  };

  std::vector<MarkerReading> unknownReadings(const FrameResult& result) const;
  PoseEstimate honestPose(const FrameResult& result) const;
  /// Returns whether the sighting adds information.
  bool keep(const MarkerSighting& sighting, Track* track) const;
  bool isGoodEnough(const Track& track) const;

  CameraModels cameras_;
  MarkerMap map_;
  MarkerMapperConfig config_;
  std::map<Key, Track> tracks_;
};

}  // namespace omnitag
