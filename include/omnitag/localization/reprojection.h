#pragma once

#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose2.h"
#include "omnitag/localization/observation.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How corners are weighed.
struct ReprojectionConfig {
  /// Pixels of the panorama, standard deviation of a corner's position along each axis.
  double corner_noise = 0.1;
  /// Pixels, RMS over a marker's corners: from here on a marker counts less and less.
  double robust_width = 0.5;
};

/// A fitted pose and how well each observation agrees with it.
struct ReprojectionFit {
  PoseEstimate map_from_base;
  /// Pixels, RMS over the corners of each observation; infinity where the pose hides a corner.
  std::vector<double> residuals;
};

/// Refines a pose so that the mapped corners image where they were measured: least squares over all
/// corners in the panoramic image (Levenberg-Marquardt), each marker weighed down as a whole by
/// Cauchy's function where its corners are far off. Where there is a prior, it takes part with its
/// covariance. The covariance is the inverse of the information that the corners (and the prior)
/// have about the pose.
///
/// Two markers, one or none are the same code; nothing where what is there leaves the pose
/// undetermined, or where the pose hides all that was observed.
std::optional<ReprojectionFit> refineByReprojection(
    const MarkerMap& map, const MountedCamera& camera,
    const std::vector<MarkerObservation>& observations, const Pose2& initial,
    const std::optional<PoseEstimate>& prior, const ReprojectionConfig& config);

}  // namespace omnitag
