#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "omnitag/marker/marker_map.h"
#include "planning/planning_scene.h"

namespace omnitag {

/// What new markers are like.
struct NewMarkers {
  int count = 0;
  /// m, edge of the square between the corners that the library reports.
  double size = 0.0;
  /// m, of their centres above the floor.
  double height = 0.0;
  std::string family;
};

struct MarkerPlacement {
  /// With unused ids of the family, the most useful first, and the deviations of a careful survey.
  std::vector<Marker> markers;
  /// As in GreedyChoice.
  double guaranteed_share = 1.0;
  /// The number of places from which they were chosen.
  std::size_t candidates = 0;
};

/// Places markers on the walls of a grid where images from the poses gain the most information
/// (chooseGreedily()). No marker covers another one, new or old. Throws InputError if the family
/// does not have enough unused ids, or if no flat piece of wall is wide enough.
MarkerPlacement placeMarkers(const PlanningScene& scene, const MarkerMap& map,
                             const std::vector<Pose>& poses, const NewMarkers& wanted, int threads);

}  // namespace omnitag
