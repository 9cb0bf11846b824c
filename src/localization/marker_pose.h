#pragma once

#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/observation.h"
#include "localization/pose_estimator.h"
#include "localization/reprojection.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The poses of the robot from which a single marker images as observed, judged by its four corners
/// and by how the prior lets the robot stand: every local optimum that is at most
/// `config.max_misfit` off, best first. A marker seen from its front often has two, turned to the
/// left and to the right.
std::vector<ReprojectionFit> posesFromMarker(const MarkerMap& map, const MountedCamera& camera,
                                             const MarkerObservation& observation,
                                             const PosePrior& prior, const EstimatorConfig& config);

/// The pose of the robot from which a marker on a wall images almost alike: on the other side of
/// the marker's normal, at the same distance, in the same direction from the robot. Small or far
/// markers do not distinguish the two. Nothing for a lying marker.
std::optional<Pose> mirroredPose(const Marker& marker, const MountedCamera& camera,
                                 const Pose& map_from_base);

}  // namespace omnitag
