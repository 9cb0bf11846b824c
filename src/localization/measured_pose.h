#pragma once

#include <optional>

#include "frame_steps.h"
#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/frame_result.h"

namespace omnitag {

/// The pose that the accepted markers of a frame tell by themselves: no image before and no
/// odometry is in it but for how odometry has the robot lean, and on a floor what FloorConfig says.
/// The frame's pose is where the search for it starts, and decides which of the two poses it is
/// that a single marker leaves, as it decides which markers are whose. An axis that the markers
/// leave open has a variance of 10^4 (m^2, rad^2). Nothing where no marker is accepted, or none
/// tells a pose.
///
/// For filters, which take each image's pose as a measurement of its own. What images share, the
/// map's and the camera's errors, is in the covariance of each.
std::optional<PoseEstimate> measuredPose(const TrackingTools& tools, const Frame& frame,
                                         const MountedCamera& camera, const FrameResult& result);

}  // namespace omnitag
