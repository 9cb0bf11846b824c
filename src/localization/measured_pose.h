#pragma once

#include <optional>

#include "camera/mounted_camera.h"
#include "localization/frame_steps.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/frame_result.h"

namespace omnitag {

/// The pose from the accepted markers of a frame alone. Of earlier images and odometry it uses only
/// the robot's lean from odometry, and on a floor FloorConfig. The frame's pose is the start of the
/// search, and decides between the two poses that a single marker leaves, as it decided the
/// associations. An axis that the markers leave open has a variance of 10^4 (m^2, rad^2). Nothing
/// if no marker is accepted, or none determines a pose.
///
/// For filters, which treat each image's pose as a separate measurement. Errors that the images
/// share, those of the map and the camera, are included in each covariance.
std::optional<PoseEstimate> measuredPose(const TrackingTools& tools, const Frame& frame,
                                         const MountedCamera& camera, const FrameResult& result);

}  // namespace omnitag
