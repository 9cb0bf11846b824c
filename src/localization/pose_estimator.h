#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/observation.h"
#include "localization/reprojection.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/estimator_config.h"
#include "omnitag/marker/marker_map.h"
#include "photometry/photometric_refinement.h"

namespace omnitag {

/// A pose, and how well each observation agrees with it.
struct PoseSolution {
  PoseEstimate map_from_base;
  ImagingError imaging_error = ImagingError::Zero();
  /// One for each observation.
  std::vector<Misfit> misfits;
  /// Whether the pose is based on the observation.
  std::vector<bool> used;
  /// How many times larger than expected the squared residuals are, at least 1.
  double excess = 1.0;
};

/// Whether a marker agrees with a pose within chance, and how many do.
bool agreesSharply(const Misfit& misfit);
std::size_t sharplyAgreeing(const std::vector<Misfit>& misfits);

/// Whether enough of the expected markers, two thirds, agree to leave no doubt about the pose. Some
/// may have been moved as one, and a few others may then seem to be in their places by chance.
bool isLargeMajority(std::size_t agreeing, std::size_t expected);

/// Estimates the robot's pose from the observations and the prior. Outliers are left out.
///
/// Triangulation uses only the prior's heading. With fewer than the three markers that it needs,
/// and with the other kinds, the pose follows from all corners and the prior with its covariance:
/// one or two bearings determine what they can, and the prior the rest. Nothing if the pose stays
/// undetermined or nothing agrees.
///
/// The additional step of kPhotometric needs the image: refinePhotometrically().
std::optional<PoseSolution> estimatePose(const MarkerMap& map, const MountedCamera& camera,
                                         const std::vector<MarkerObservation>& observations,
                                         const PosePrior& prior, const EstimatorConfig& config);

}  // namespace omnitag
