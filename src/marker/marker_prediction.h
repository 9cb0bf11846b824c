#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "marker/marker_index.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/predicted_marker.h"
#include "omnitag/marker/visibility_config.h"
#include "omnitag/view/view.h"
#include "view/view_target.h"

namespace omnitag {

/// The markers that the camera should see: facing it, within range, large enough, and entirely
/// within the optics' field and the image.
std::vector<PredictedMarker> predictMarkers(const MarkerMap& map, const MountedCamera& camera,
                                            const PoseEstimate& map_from_base,
                                            const VisibilityConfig& config);

/// The same with the map's index, which is much faster for a large map.
std::vector<PredictedMarker> predictMarkers(const MarkerMap& map, const MarkerIndex& index,
                                            const MountedCamera& camera,
                                            const PoseEstimate& map_from_base,
                                            const VisibilityConfig& config);

/// The prediction of one marker; nothing if the camera should not see it.
std::optional<PredictedMarker> predictMarker(const MarkerMap& map, std::size_t entry,
                                             const MountedCamera& camera,
                                             const PoseEstimate& map_from_base,
                                             const VisibilityConfig& config);

/// Length of a quadrilateral's longest edge.
double longestEdge(const Corners<Eigen::Vector2d>& corners);

/// The part of the panorama in which to look for a marker: its corners, the white border without
/// which it cannot be read, and its margins.
ViewTarget viewTarget(const PredictedMarker& marker, const CameraModel& camera);

}  // namespace omnitag
