#pragma once

#include <optional>

#include "adjustment/calibration_data.h"
#include "camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The pose of a robot that moves freely, from the corners of a frame's markers and a camera that
/// may be wrong by a few percent: of the poses from which single markers look as observed, the one
/// from which all of them image nearest to where they were read. Nothing if none is near.
std::optional<Pose> poseFromCorners(const MarkerMap& map, const MountedCamera& camera,
                                    const CalibrationFrame& frame);

}  // namespace omnitag
