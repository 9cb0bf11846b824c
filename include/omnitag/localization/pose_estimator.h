#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
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
  /// Standard deviations (Misfit): a marker that is farther off is rejected.
  double max_misfit = 7.0;
  PhotometricConfig photometric;
  /// Pixels of the panorama: standard deviation that the lens's blur is taken for until the images
  /// tell.
  double blur = 0.0;
};

/// Reads the keys of ReprojectionConfig, max_misfit, blur, and those of PhotometricConfig; absent
/// ones keep their defaults. Throws InputError.
EstimatorConfig readEstimatorConfig(const YamlReader& reader);

/// A pose, and what it makes of each observation.
struct PoseSolution {
  PoseEstimate map_from_base;
  ImagingError imaging_error = ImagingError::Zero();
  /// Of each observation.
  std::vector<Misfit> misfits;
  /// Whether the pose stands on the observation.
  std::vector<bool> used;
  /// How many times larger than expected the squared residuals are, at least 1.
  double excess = 1.0;
};

/// How many markers agree with a pose as well as by chance.
std::size_t sharplyAgreeing(const std::vector<Misfit>& misfits);

/// Whether enough of the markers that are expected, two thirds, leave no doubt that the pose on
/// which they agree is right. Some may have been moved as one, and then one or the other that was
/// not may seem in its place by chance.
bool isLargeMajority(std::size_t agreeing, std::size_t expected);

/// Estimates the robot's pose from what was observed and the prior. Observations that disagree with
/// the others are left out.
///
/// Triangulation uses the prior for its heading only. Where there are fewer than the three markers
/// that it needs, and with the other kinds, all corners and the prior with its covariance give the
/// pose: two bearings, which leave a line of poses, or one, then decide as far as they can, and the
/// prior the rest. Nothing where the pose stays undetermined or nothing agrees.
///
/// What kPhotometric adds needs the image: refinePhotometrically().
std::optional<PoseSolution> estimatePose(const MarkerMap& map, const MountedCamera& camera,
                                         const std::vector<MarkerObservation>& observations,
                                         const PosePrior& prior, const EstimatorConfig& config);

}  // namespace omnitag
