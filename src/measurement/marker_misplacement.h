#pragma once

#include "omnitag/camera/camera_model.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// By how much a marker may hang elsewhere than the map says: standard deviations along (m) and
/// about (rad) each axis.
struct Misplacement {
  double position = 0.0;
  double orientation = 0.0;

  bool isNone() const { return position == 0.0 && orientation == 0.0; }
};

/// The map may be wrong, and a camera displaces each marker a little in addition to what its smooth
/// modes can describe. `alignment_deviation`: pixels, by which a marker is displaced even if the
/// camera is exact.
Misplacement misplacementOf(const Marker& marker, const CameraModel& camera,
                            double pixels_per_metre, double alignment_deviation);

/// A misplaced marker looks as if seen from another pose. The covariance of that change of the pose
/// (a PoseVector).
PoseMatrix seenFrom(const Pose& map_from_base, const Marker& marker,
                    const Misplacement& misplacement);

}  // namespace omnitag
