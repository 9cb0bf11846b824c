#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "omnitag/marker/marker_map.h"
#include "planning/occupancy_grid.h"
#include "planning/planning_scene.h"

namespace omnitag {

/// How the headings at one place are summed up.
enum class Headings {
  kWorst,  ///< the fewest markers and the largest deviations
  kMean,   ///< the median of the counts, and the root mean square of the deviations
};

/// How well one image from a place of the floor tells the pose.
struct PlacePrediction {
  /// m, base_link in the map.
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  /// How many are recognized.
  int markers = 0;
  /// m, of x and y together, and rad; nothing without a marker.
  std::optional<double> position_deviation;
  std::optional<double> heading_deviation;
};

/// A map's prediction over a floor.
struct FloorPrediction {
  /// m, between neighbouring places.
  double step = 0.0;
  std::vector<PlacePrediction> places;
};

/// The places of a grid at which a robot can stand: free cells with this clearance (m), about
/// `step` metres apart in both directions, a whole number of cells. A step of 0 chooses one that
/// gives about 3000 places, no finer than a cell. Without predictions.
FloorPrediction placesOn(const OccupancyGrid& grid, double step, double clearance);

/// The poses at these places with `count` headings, evenly spread, place by place.
std::vector<Pose> posesAt(const std::vector<PlacePrediction>& places, int count);

/// The floor with what its images show: `headings` at each place. Throws InputError for a marker
/// whose pattern is unknown.
FloorPrediction predictFloor(const PlanningScene& scene, const MarkerMap& map,
                             const FloorPrediction& floor, int headings, Headings summary,
                             int threads);

}  // namespace omnitag
