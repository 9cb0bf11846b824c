#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/marker_memory.h"
#include "omnitag/localization/observation.h"
#include "omnitag/localization/pose_estimator.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How far a marker hangs from its place in the map, as it was observed from a known pose of the
/// robot, at the height and the tilt that the map says; of several entries with its id, the
/// nearest. `standing`: how the robot stands. `observation.map_entry` is not looked at. Nothing
/// where the map has no such marker, or where none at this height looks like what was observed.
std::optional<DisplacedMarker> displacement(const MarkerMap& map, const MountedCamera& camera,
                                            const std::string& family, int id,
                                            const MarkerObservation& observation,
                                            const Pose& map_from_base, const PosePrior& standing,
                                            const EstimatorConfig& config);

/// By how much a group of two markers or more was moved as one; nothing where that is not known.
std::optional<GroupDisplacement> displacement(const MarkerMap& map, const DisplacedGroup& group);

/// Which markers the map has at a wrong place, as frame after frame says.
class DisplacementLog {
 public:
  void add(const FrameResult& result);

  /// Entries that were measured displaced three times and, since then, never seen where the map has
  /// them; each with the mean distance.
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
