#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose2.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/localization/observation.h"
#include "omnitag/localization/reprojection.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/photometry/photometric_refinement.h"

namespace omnitag {

/// How a pose is computed from the markers that were read.
enum class EstimatorKind {
  kTriangulation,  ///< the paper's: bearings of the centres, Eqns 1 and 2
  kReprojection,   ///< all corners, in the panoramic image
  kPhotometric,    ///< all pixels of the markers, starting from the corners
};

struct EstimatorConfig {
  EstimatorKind kind = EstimatorKind::kPhotometric;
  ReprojectionConfig reprojection;
  /// Pixels of the panorama, RMS over a marker's corners: beyond, a marker is rejected.
  double max_residual = 1.5;
  PhotometricConfig photometric;
};

/// Reads the keys corner_noise, robust_width and max_residual, and those of PhotometricConfig;
/// absent ones keep their defaults. Throws InputError.
EstimatorConfig readEstimatorConfig(const YamlReader& reader);

/// A pose, and what it makes of each observation.
struct PoseSolution {
  PoseEstimate map_from_base;
  /// Pixels, RMS over the corners of each observation; infinity where the pose hides a corner.
  std::vector<double> residuals;
  /// Whether the pose stands on the observation.
  std::vector<bool> used;
};

/// How many markers, of these residuals (pixels), agree with a pose sharply: an exact map and sharp
/// corners leave no more.
std::size_t sharplyAgreeing(const std::vector<double>& residuals, const EstimatorConfig& config);

/// Whether so many of the markers that are expected, two thirds, leave no doubt that the pose on
/// which they agree is right. Some may have been moved as one, and then one or the other that was
/// not may seem in its place by chance.
bool isLargeMajority(std::size_t agreeing, std::size_t expected);

/// Estimates the robot's pose from what was observed and, where there is one, the predicted pose.
/// Observations that disagree with the others are left out.
///
/// Triangulation uses the prior for its heading only. Where there are fewer than the three markers
/// that it needs, and with the other kinds, all corners and the prior with its covariance give the
/// pose: two bearings, which leave a line of poses, or one, then decide as far as they can, and the
/// prior the rest. Nothing where the pose stays undetermined or nothing agrees.
///
/// What kPhotometric adds needs the image: refinePhotometrically().
std::optional<PoseSolution> estimatePose(const MarkerMap& map, const MountedCamera& camera,
                                         const std::vector<MarkerObservation>& observations,
                                         const std::optional<PoseEstimate>& prior,
                                         const EstimatorConfig& config);

}  // namespace omnitag
