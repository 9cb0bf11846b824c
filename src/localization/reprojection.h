#pragma once

#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/observation.h"
#include "measurement/frame_equations.h"
#include "measurement/pose_prior.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/reprojection_config.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How far the corners of an observation are off their projections from a pose.
struct Misfit {
  /// Pixels, RMS over the corners; infinity if a corner is not visible from the pose.
  double residual = 0.0;
  /// Standard deviations, RMS over the corners' coordinates, by the covariances of poor corners and
  /// of the marker's place in the map. About 1 if all is well.
  double deviations = 0.0;
};

/// A fitted pose and how well each observation agrees with it.
struct ReprojectionFit {
  PoseEstimate map_from_base;
  /// The camera's estimated imaging error.
  ImagingError imaging_error = ImagingError::Zero();
  std::vector<Misfit> misfits;
  /// How many times larger than expected the squared residuals are, at least 1: a map or a camera
  /// that is less exact than its file says must not make the pose look more certain than it is.
  double excess = 1.0;
};

/// Refines a pose so that the mapped corners image where they were measured: least squares over all
/// corners in the panoramic image (Levenberg-Marquardt). Markers may be out of place within their
/// deviations, the camera may err within its uncertainty, and the farther off a marker is beyond
/// that, the less it counts. The covariance includes all these, times the excess.
///
/// The same code serves for two markers, one or none. Nothing if the pose stays undetermined, or if
/// none of the observed markers is visible from it.
std::optional<ReprojectionFit> refineByReprojection(
    const MarkerMap& map, const MountedCamera& camera,
    const std::vector<MarkerObservation>& observations, const Pose& initial, const PosePrior& prior,
    const ReprojectionConfig& config);

/// The same from a start that may be far off: the robust width is large at first, so that all
/// markers pull, and narrows down to the configured one.
std::optional<ReprojectionFit> refineFromAfar(const MarkerMap& map, const MountedCamera& camera,
                                              const std::vector<MarkerObservation>& observations,
                                              const Pose& initial, const PosePrior& prior,
                                              const ReprojectionConfig& config);

/// One for each observation, at a pose and an imaging error.
std::vector<Misfit> misfitsAt(const MarkerMap& map, const MountedCamera& camera,
                              const std::vector<MarkerObservation>& observations,
                              const Pose& map_from_base, const ImagingError& error,
                              const ReprojectionConfig& config);

/// What the corners of each observation say about the frame's unknowns, linearised at a pose and an
/// imaging error, with the noise of poor corners; nothing for a marker that is not visible from the
/// pose.
std::vector<std::optional<FrameEquations>> equationsAt(
    const MarkerMap& map, const MountedCamera& camera,
    const std::vector<MarkerObservation>& observations, const Pose& map_from_base,
    const ImagingError& error, const ReprojectionConfig& config);

}  // namespace omnitag
