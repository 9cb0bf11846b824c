#pragma once

#include <vector>

#include "camera/mounted_camera.h"
#include "localization/observation.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The poses (all six numbers, however the robot then stands) from which a marker images about as
/// observed: in closed form, as starts of an iteration. There are two, with the marker turned about
/// its middle to either side of the line of sight; one if these coincide; none if the camera has no
/// line of sight for a corner.
///
/// The homography from the marker's plane to the lines of sight determines how a small square at
/// the marker's middle images: an affine map, A = R_2x2 / distance, R being the marker's
/// orientation seen along the line of sight. Its larger singular value is 1 / distance, and A's
/// deviation from a rotation gives the slant except for its sign (Collins and Bartoli,
/// Infinitesimal Plane-based Pose Estimation, 2014). A mirror's lines of sight do not meet in one
/// point; they are replaced by lines from their mean origin to their points at the marker's
/// distance.
std::vector<Pose> planarPoses(const Marker& marker, const MountedCamera& camera,
                              const MarkerObservation& observation);

/// The other pose, however the robot then stands, from which a marker looks almost as it does from
/// `map_from_base`: slanted the other way about the line of sight. With small or far markers, the
/// two cannot be told apart.
Pose flippedPose(const Marker& marker, const MountedCamera& camera, const Pose& map_from_base);

}  // namespace omnitag
