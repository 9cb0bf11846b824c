#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "marker/tag_pattern.h"
#include "measurement/frame_equations.h"
#include "measurement/pose_prior.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/photometry/blur_equations.h"
#include "omnitag/photometry/disagreement.h"
#include "omnitag/photometry/photometric_config.h"

namespace omnitag {

/// A pose that was aligned with the panorama.
struct PhotometricFit {
  PoseEstimate map_from_base;
  /// Estimated error of the camera.
  ImagingError imaging_error = ImagingError::Zero();
  /// Equations for the blur, at the blur that the camera was assumed to have.
  BlurEquations blur;
  /// Standard deviations estimated from the residuals: grey levels on even ground, and the random
  /// displacement of edges from pixel to pixel, in pixels.
  double noise = 0.0;
  double edge_noise = 0.0;
  /// How much the markers disagree, given the errors of their pixels, the map and the camera; the
  /// factor by which that exceeds earlier images, if not by chance; and the factor by which squared
  /// errors therefore exceed what is expected. The last two are at least 1.
  Disagreement disagreement;
  double surprise = 1.0;
  double excess = 1.0;
  /// Equations of each marker at this pose and error, with their errors; nothing for a marker that
  /// is not seen.
  std::vector<std::optional<FrameEquations>> markers;
  /// Weight of each marker: less than 1 if it disagrees with the others.
  std::vector<double> weights;
};

/// Twice the negative log-likelihood of the pixels at a pose, up to a constant, at the noise that
/// `fit` found. Of several optima the one with the smallest misfit is the likeliest.
double photometricMisfit(const cv::Mat& panorama, const MarkerMap& map, const MountedCamera& camera,
                         const TagPatterns& patterns, const std::vector<std::size_t>& entries,
                         const Pose& map_from_base, const PhotometricFit& fit,
                         const PhotometricConfig& config);

/// Refines a pose, known to about half a pixel, so that the patterns of the markers at `entries`
/// explain the panorama's grey levels. Every pixel of a marker is predicted as black + white *
/// contrast, where white is the pattern's average over what the pixel sees of it. Black and the
/// contrast, a polynomial of the second degree over the marker, are free for each marker. Least
/// squares over pixels at edges (Gauss-Newton), with covered pixels weighted down, and with the
/// priors of the pose, of the camera's error and of the markers' places.
///
/// The covariance is the sandwich estimator (Huber, White): that of the weighted estimate if
/// its pixels err as their residuals show, enlarged by the deviations of the configuration.
/// Markers that disagree with the others by more than that count less and enlarge it. Nothing
/// if the alignment does not converge or leaves the pose undetermined. `panorama`: CV_8UC1.
/// `threads`: how many markers are processed at once; does not affect the result.
/// `lasting_excess`: from LastingDisagreement.
std::optional<PhotometricFit> refinePhotometrically(const cv::Mat& panorama, const MarkerMap& map,
                                                    const MountedCamera& camera,
                                                    const TagPatterns& patterns,
                                                    const std::vector<std::size_t>& entries,
                                                    const Pose& initial, const PosePrior& prior,
                                                    const PhotometricConfig& config,
                                                    int threads = 1, double lasting_excess = 1.0);

}  // namespace omnitag
