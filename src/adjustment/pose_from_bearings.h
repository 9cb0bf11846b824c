#pragma once

#include <optional>

#include "adjustment/calibration_data.h"
#include "camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The robot's pose from a frame's bearings, found without an initial heading. For an upright
/// camera, it only depends on the centre and the aspect ratio of the image: azimuth does not depend
/// on how the optics image elevation. Good enough as a start if the centre is some pixels off or
/// the camera leans. Nothing if no pose explains the bearings.
std::optional<Pose> poseFromBearings(const MarkerMap& map, const MountedCamera& camera,
                                     const CalibrationFrame& frame);

}  // namespace omnitag
