#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/marker_memory.h"
#include "localization/observation.h"
#include "localization/pose_estimator.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How far a marker, observed from a known pose of the robot, hangs from its place in the map,
/// assuming the map's height and tilt for it. If several entries have its id, the nearest counts.
/// `standing`: how the robot stands. `observation.map_entry` is ignored. Nothing if the map has no
/// such marker, or if no marker at that height would look as observed.
std::optional<DisplacedMarker> displacement(const MarkerMap& map, const MountedCamera& camera,
                                            const std::string& family, int id,
                                            const MarkerObservation& observation,
                                            const Pose& map_from_base, const PosePrior& standing,
                                            const EstimatorConfig& config);

/// How far a group of two or more markers was moved as one; nothing if that is not known.
std::optional<GroupDisplacement> displacement(const MarkerMap& map, const DisplacedGroup& group);

/// Collects over many frames which markers the map has in a wrong place.
class DisplacementLog {
 public:
  void add(const FrameResult& result);

  /// Entries that were measured displaced three times and have not been seen in their mapped places
  /// since, each with its mean distance.
  std::vector<DisplacedMarker> persistent() const;

  void clear() { sightings_.clear(); }

 private:
  struct Sightings {
    int count = 0;
    double mean_distance = 0.0;
  };
  std::map<std::size_t, Sightings> sightings_;
};

}  // namespace omnitag
