#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/tag_pattern.h"
#include "omnitag/measurement/frame_equations.h"
#include "omnitag/measurement/pose_prior.h"
#include "omnitag/photometry/blur_equations.h"
#include "omnitag/photometry/disagreement.h"

namespace omnitag {

/// How a pose is aligned with the grey levels of the panorama.
struct PhotometricConfig {
  /// Grey levels, the least that noise is taken for: grey levels are rounded, and no pattern is
  /// printed and lit as evenly as in the model.
  double min_noise = 1.0;
  /// Pixels of the panorama: standard deviation of what all of a marker's pixels err by together,
  /// since neither the camera model nor the pattern's is perfect.
  double alignment_deviation = 0.0015;
  /// Pixels at edges of modules that are used, at most, of all markers together: until the pose is
  /// nearly right, and for the last step from there. More of the latter make the pose more exact.
  /// Of each marker up to 75 are used all the same.
  int max_pixels = 600;
  int max_final_pixels = 12000;
};

/// A pose that was aligned with the panorama.
struct PhotometricFit {
  PoseEstimate map_from_base;
  /// What the camera seems to be off by.
  ImagingError imaging_error = ImagingError::Zero();
  /// What the pixels say of the blur that the camera was taken to have.
  BlurEquations blur;
  /// Standard deviations as the residuals tell them: grey levels on even ground, and pixels by
  /// which edges seem displaced by chance from pixel to pixel.
  double noise = 0.0;
  double edge_noise = 0.0;
  /// How much the markers disagree by these, the map and the camera; how many times more than
  /// images before, where that is not by chance; and how many times larger than expected squared
  /// errors hence are. The last two are at least 1.
  Disagreement disagreement;
  double surprise = 1.0;
  double excess = 1.0;
  /// What each marker says at this pose and error, with what it errs by; nothing for one that is
  /// not seen.
  std::vector<std::optional<FrameEquations>> markers;
  /// For each marker how much it counts: less than 1 where it disagrees with the others.
  std::vector<double> weights;
};

/// How badly a pose explains the pixels: twice the negative log-likelihood, up to a constant, at
/// the noise that `fit` found. Tells which of several optima is the likelier.
double photometricMisfit(const cv::Mat& panorama, const MarkerMap& map, const MountedCamera& camera,
                         const TagPatterns& patterns, const std::vector<std::size_t>& entries,
                         const Pose& map_from_base, const PhotometricFit& fit,
                         const PhotometricConfig& config);

/// Refines a pose, good to about half a pixel, so that the patterns of the markers at `entries`
/// explain the panorama's grey levels: every pixel of a marker is predicted as black + white *
/// contrast, white being the pattern's average over what the pixel sees of it. Black and the
/// contrast, a polynomial of the second degree over the marker, are free for each marker. Least
/// squares over pixels at edges (Gauss-Newton), with pixels that something covers weighed down;
/// the priors of the pose, of the camera's error and of the markers' places take part.
///
/// The covariance is that of an estimate so weighted whose pixels err as their residuals show
/// (Huber's and White's sandwich), enlarged by the deviations of the configuration; markers that
/// disagree with the others by more than that count less and raise it. Nothing where the alignment
/// does not converge or leaves the pose undetermined. `panorama`: CV_8UC1. `threads`: how many
/// markers are worked on at once; the result is the same. `lasting_excess`: LastingDisagreement's.
std::optional<PhotometricFit> refinePhotometrically(const cv::Mat& panorama, const MarkerMap& map,
                                                    const MountedCamera& camera,
                                                    const TagPatterns& patterns,
                                                    const std::vector<std::size_t>& entries,
                                                    const Pose& initial, const PosePrior& prior,
                                                    const PhotometricConfig& config,
                                                    int threads = 1, double lasting_excess = 1.0);

}  // namespace omnitag
