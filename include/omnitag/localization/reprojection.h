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
  double corner_noise = 0.045;
  /// Pixels: a corner that is farther off than this counts less and less, as does one at an edge
  /// that something covers.
  double robust_width = 0.25;
};

/// A fitted pose and how well each observation agrees with it.
struct ReprojectionFit {
  PoseEstimate map_from_base;
  /// Pixels, RMS over the corners of each observation; infinity where the pose hides a corner.
  std::vector<double> residuals;
  /// Sum over all corners of their squared residuals in corner noises, each with its robust weight.
  double weighted_squares = 0.0;
};

/// Refines a pose so that the mapped corners image where they were measured: least squares over all
/// corners in the panoramic image (Levenberg-Marquardt), each weighed down by Cauchy's function
/// where it is far off. Where there is a prior, it takes part with its covariance. The covariance
/// is the inverse of the information that the corners (and the prior) have about the pose.
///
/// Two markers, one or none are the same code; nothing where what is there leaves the pose
/// undetermined, or where the pose hides all that was observed.
std::optional<ReprojectionFit> refineByReprojection(
    const MarkerMap& map, const MountedCamera& camera,
    const std::vector<MarkerObservation>& observations, const Pose2& initial,
    const std::optional<PoseEstimate>& prior, const ReprojectionConfig& config);

/// The same from a start that may be far off: with a robust width that is wide at first, so that
/// all markers pull, and narrows down to the configured one.
std::optional<ReprojectionFit> refineFromAfar(const MarkerMap& map, const MountedCamera& camera,
                                              const std::vector<MarkerObservation>& observations,
                                              const Pose2& initial,
                                              const std::optional<PoseEstimate>& prior,
                                              const ReprojectionConfig& config);

/// How many times larger than expected the squared residuals of a fit are, at least 1: a map that
/// is not as exact as the corners must not make the pose look more certain than it is.
double varianceFactor(const ReprojectionFit& fit);

/// Pixels, RMS over the corners of each observation; infinity where the pose hides a corner.
std::vector<double> reprojectionResiduals(const MarkerMap& map, const MountedCamera& camera,
                                          const std::vector<MarkerObservation>& observations,
                                          const Pose2& map_from_base);

}  // namespace omnitag
