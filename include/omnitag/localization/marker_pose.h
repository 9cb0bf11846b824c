#pragma once

#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/observation.h"
#include "omnitag/localization/pose_estimator.h"
#include "omnitag/localization/reprojection.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The poses of the robot from which a single marker images as it was observed, judged by its four
/// corners alone, and by how the prior lets it stand: every local optimum that is at most
/// `config.max_misfit` off, best first.
/// Seen from its front a marker often has two, which turn it to the left and to the right.
std::vector<ReprojectionFit> posesFromMarker(const MarkerMap& map, const MountedCamera& camera,
                                             const MarkerObservation& observation,
                                             const PosePrior& prior, const EstimatorConfig& config);

/// The pose of the robot from which a marker on a wall images almost alike: on the other side of
/// the marker's normal, as far away, in the same direction from the robot. Small or far markers do
/// not tell the two apart. Nothing for a marker that lies.
std::optional<Pose> mirroredPose(const Marker& marker, const MountedCamera& camera,
                                 const Pose& map_from_base);

}  // namespace omnitag
