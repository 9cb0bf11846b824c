#pragma once

#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/observation.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The poses, with all six numbers, from which a marker images about as it was observed, however
/// the robot stands: in closed form, to start an iteration from. There are two, which turn the
/// marker about its middle to one side of the line of sight and to the other; one where these
/// coincide; none where the camera has no line of sight for a corner.
///
/// The homography from the marker's plane to the lines of sight tells, at the marker's middle, how
/// a small square images: an affine map, A = R_2x2 / distance, R being the marker's orientation
/// seen along the line of sight. Its larger singular value is 1 / distance, and what A lacks of a
/// rotation is the slant, but for its sign (Collins and Bartoli, Infinitesimal Plane-based Pose
/// Estimation, 2014). A mirror's lines of sight do not meet in one point: they are taken to where
/// the marker is, seen from their mean origin.
std::vector<Pose> planarPoses(const Marker& marker, const MountedCamera& camera,
                              const MarkerObservation& observation);

/// The pose, however the robot then stands, from which a marker images almost as it does from
/// `map_from_base`: slanted the other way about the line of sight. Small or far markers do not tell
/// the two apart.
Pose flippedPose(const Marker& marker, const MountedCamera& camera, const Pose& map_from_base);

}  // namespace omnitag
