#pragma once

#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose2.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/localization/observation.h"
#include "omnitag/localization/reprojection.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How a pose is computed from the markers that were read.
enum class EstimatorKind {
  kTriangulation,  ///< the paper's: bearings of the centres, Eqns 1 and 2
  kReprojection,   ///< all corners, in the panoramic image
};

struct EstimatorConfig {
  EstimatorKind kind = EstimatorKind::kReprojection;
  ReprojectionConfig reprojection;
  /// Pixels of the panorama, RMS over a marker's corners: beyond, a marker is rejected.
  double max_residual = 1.5;
};

/// Reads the keys corner_noise, robust_width and max_residual; absent ones keep their defaults.
/// Throws InputError.
EstimatorConfig readEstimatorConfig(const YamlReader& reader);

/// A pose, and what it makes of each observation.
struct PoseSolution {
  PoseEstimate map_from_base;
  /// Pixels, RMS over the corners of each observation; infinity where the pose hides a corner.
  std::vector<double> residuals;
  /// Whether the pose stands on the observation.
  std::vector<bool> used;
};

/// Estimates the robot's pose from what was observed and, where there is one, the predicted pose.
/// Observations that disagree with the others are left out.
///
/// Triangulation wants three markers and uses the prior for its heading only. Reprojection takes
/// any number and the prior with its covariance. Nothing where the pose stays undetermined or
/// nothing agrees.
std::optional<PoseSolution> estimatePose(const MarkerMap& map, const MountedCamera& camera,
                                         const std::vector<MarkerObservation>& observations,
                                         const std::optional<PoseEstimate>& prior,
                                         const EstimatorConfig& config);

}  // namespace omnitag
