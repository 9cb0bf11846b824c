#pragma once

#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A marker that hangs elsewhere than the map says is seen as from another pose. The covariance of
/// that change of the pose (a PoseVector), for standard deviations of the marker's position (m) and
/// orientation (rad) along and about each axis.
PoseMatrix misplacementOf(const Marker& marker, const Pose& map_from_base, double deviation,
                          double orientation_deviation);

}  // namespace omnitag
