#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "omnitag/adjustment/marker_estimate.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How a map is extended while the robot drives, and when what it sees is good enough.
struct MarkerMapperConfig {
  /// How many views' worth unknown markers are looked for in each frame, as
  /// LocalizerConfig::exploring_views.
  int views_per_frame = 2;
  /// m, of unknown markers; 0: the map's default size.
  double size = 0.0;
  /// Whether the sizes of unknown markers are estimated, that size being a first guess.
  bool estimate_sizes = false;
  /// Pixels of the panorama, standard deviation of a decoded corner along each axis.
  double corner_noise = 0.1;
  /// m: a pose that is less certain than this (standard deviation) tells nothing about markers.
  double max_pose_deviation = 0.05;
  /// Sightings of a marker that are kept, and m between the places that they are from.
  int max_sightings = 24;
  double min_step = 0.15;
  /// When a marker is used: sightings, the angle between the directions it was seen from (rad), the
  /// share of sightings that agree, and standard deviations in the direction in which they are
  /// largest (m and rad).
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
  /// rad, the largest angle between the directions it was seen from.
  double parallax = 0.0;
  /// Whether the map has it.
  bool is_used = false;
};

/// Extends a map by the markers that a localizer reads and the map does not have: keeps sightings
/// of each, estimates its place as the robot moves, and adds it to the map once that is good
/// enough. What the map had from the beginning is never touched.
///
/// Poses that stand on markers of this mapper's own err along with these: their uncertainty is
/// added to a pose's, in the share that such markers have in it. Not safe to use from two threads
/// at once.
class MarkerMapper {
 public:
  /// Throws InputError where neither the configuration nor the map says how large unknown markers
  /// are.
  MarkerMapper(std::shared_ptr<const CameraModel> camera, MarkerMap map,
               const MarkerMapperConfig& config);

  /// Takes what a frame showed. Returns whether map() has changed.
  bool add(const Frame& frame, const FrameResult& result);

  /// The map with those markers that are good enough behind its own, at indices that stay.
  const MarkerMap& map() const { return map_; }

  /// Those of which something is known, by family and id.
  std::vector<ProvisionalMarker> provisional() const;

  /// Where those seem to hang that are not good enough yet.
  std::vector<Marker> unfinished() const;

  /// Takes another version of the map's own markers, as one into which markers were saved. What it
  /// has now stays as it is; what mapping knows besides stays behind it.
  void setOwn(MarkerMap own);

 private:
  using Key = std::pair<std::string, int>;
  struct Track {
    std::vector<MarkerSighting> sightings;
    std::optional<MarkerEstimate> estimate;
    /// Its place in map().
    std::optional<std::size_t> entry;
    /// Sightings at two places at once: not one marker but two.
    int repetitions = 0;
  };

  std::vector<MarkerReading> unknownReadings(const FrameResult& result) const;
  PoseEstimate honestPose(const FrameResult& result) const;
  /// Returns whether the sighting told something new.
  bool keep(const MarkerSighting& sighting, Track* track) const;
  bool isGoodEnough(const Track& track) const;

  std::shared_ptr<const CameraModel> camera_;
  MarkerMap map_;
  MarkerMapperConfig config_;
  std::map<Key, Track> tracks_;
};

}  // namespace omnitag
