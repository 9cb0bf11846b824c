#pragma once

#include <optional>

#include "omnitag/adjustment/calibration_data.h"
#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The robot's pose from a frame's bearings, found without a starting heading. Of the camera it
/// takes nothing but the centre and the aspect of its image: azimuth survives whatever the optics
/// do to elevation. With a centre that is some pixels off or a camera that leans it is good for a
/// start. Nothing where no pose explains the bearings.
std::optional<Pose> poseFromBearings(const MarkerMap& map, const MountedCamera& camera,
                                     const CalibrationFrame& frame);

}  // namespace omnitag
