#pragma once

#include <memory>
#include <optional>

#include "camera/mounted_camera.h"
#include "localization/pose_estimator.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/frame_result.h"

namespace omnitag {

/// camera_from_marker of a marker of this size (m) from its four corners alone, between the
/// camera's optical frame and the marker's (Marker), with the covariance due to the corners' noise
/// and the camera's uncertainty. `expected`: where the map and the frame's pose put the marker,
/// which decides between two possible poses; without it, the better fit does. None if no pose
/// explains the corners.
std::optional<PoseEstimate> markerInCamera(std::shared_ptr<const CameraModel> camera,
                                           const MarkerDetection& detection, double size,
                                           const std::optional<Eigen::Isometry3d>& expected,
                                           const EstimatorConfig& config);

/// m, size of a detected marker: that of its map entry; without one, that of an entry with its
/// family and id, or else the map's default; 0 if that is not known either.
double sizeOf(const MarkerDetection& detection, const MarkerMap& map);

}  // namespace omnitag
