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
/// and by how the robot may stand according to the prior: every local optimum that is at most
/// `config.max_misfit` off, best first. A marker seen from its front often has two, turned to the
/// left and to the right.
std::vector<ReprojectionFit> posesFromMarker(const MarkerMap& map, const MountedCamera& camera,
                                             const MarkerObservation& observation,
                                             const PosePrior& prior, const EstimatorConfig& config);

/// The other pose of the robot from which a marker on a wall looks almost the same: on the other
/// side of the marker's normal, at the same distance, with the marker in the same direction from
/// the robot. With small or far markers, the two cannot be told apart. Nothing for a lying marker.
std::optional<Pose> mirroredPose(const Marker& marker, const MountedCamera& camera,
                                 const Pose& map_from_base);

}  // namespace omnitag
