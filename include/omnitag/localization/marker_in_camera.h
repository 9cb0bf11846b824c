#pragma once

#include <memory>
#include <optional>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/pose_estimator.h"

namespace omnitag {

/// camera_from_marker of a marker of this size (m), as its four corners tell it by themselves: the
/// camera's optical frame and the marker's (Marker), with the covariance that the corners' noise
/// and the camera's uncertainty leave. `expected`: where the map and the frame's pose have it,
/// which then decides between the two poses that a marker may leave; without, the better one. None
/// where no pose explains the corners.
std::optional<PoseEstimate> markerInCamera(std::shared_ptr<const CameraModel> camera,
                                           const MarkerDetection& detection, double size,
                                           const std::optional<Eigen::Isometry3d>& expected,
                                           const EstimatorConfig& config);

/// m, of a marker that was detected: its map entry's; where it has none, that of an entry of its
/// family and id, or else the map's default; 0 where that is not known either.
double sizeOf(const MarkerDetection& detection, const MarkerMap& map);

}  // namespace omnitag
