#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The marker map for RViz: `tags`, drawn with their border, white inside and grey on their back;
/// `normals`, an arrowhead out of each face; `names`, the entry's name or its id.
visualization_msgs::MarkerArray mapMarkers(const MarkerMap& map, const std::string& map_frame);

}  // namespace omnitag
