#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "planning/pattern_edges.h"
#include "planning/planning_scene.h"

namespace omnitag {

/// Whether a marker faces a viewpoint (m, in the map), and only free cells are between them: seen
/// from above, up to its middle and both of its ends. Obstacles count as high as the ceiling.
/// `wall_depth`: m, see PlanningConfig.
bool isInSight(const OccupancyGrid& grid, const Eigen::Vector3d& viewpoint, const Marker& marker,
               double wall_depth);

/// Whether the marker at an entry of the map would be recognized where it is predicted: it is in
/// sight, the camera sees all of it, and its modules are large enough in the image
/// (smallestModulesOf()). `edges`: its pattern's.
bool isRecognized(const PlanningScene& scene, const MarkerMap& map, std::size_t entry,
                  const PatternEdges& edges, const Pose& map_from_base);

}  // namespace omnitag
