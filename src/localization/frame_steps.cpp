#include "localization/frame_steps.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "common/parallel.h"
#include "common/stopwatch.h"
#include "localization/marker_pose.h"
#include "localization/planar_pose.h"
#include "marker/marker_prediction.h"
#include "omnitag/common/angle.h"
#include "photometry/recognition.h"

namespace omnitag {
namespace {

/// Mean and covariance of a pose with two possible estimates, each with its misfit (twice the
/// negative log-likelihood).
PoseEstimate mixture(const PoseEstimate& a, double misfit_a, const PoseEstimate& b,
                     double misfit_b) {
  const double ratio = std::exp(0.5 * std::clamp(misfit_a - misfit_b, -100.0, 100.0)) *
                       std::sqrt(b.covariance.determinant() / a.covariance.determinant());
  const double share = ratio / (1.0 + ratio);
  const PoseVector apart = difference(b.pose, a.pose);
  PoseEstimate mean;
  mean.pose = moved(a.pose, share * apart);
  mean.shared = (1.0 - share) * a.shared + share * b.shared;
  mean.covariance = (1.0 - share) * a.covariance + share * b.covariance +
                    share * (1.0 - share) * apart * apart.transpose();
  return mean;
}

}  // namespace

bool agreesWithPrior(const MarkerMap& map, const EstimatorConfig& config,
                     const MountedCamera& camera, const MarkerObservation& observation,
                     const PosePrior& prior) {
  // Chi-square with six degrees of freedom, exceeded once in a thousand.
  constexpr double kFarOff = 22.5;
  ReprojectionConfig trusting = config.reprojection;
  trusting.corner_noise = trusting.poor_corner_noise;
  const auto fit = refineByReprojection(map, camera, {observation}, prior.pose, prior, trusting);
  if (!fit || fit->misfits.front().deviations > config.max_misfit) return false;
  const PoseVector off = prior.errorOf(fit->map_from_base.pose);
  return off.dot(prior.information * off) <= kFarOff;
}

MarkerDetection toDetection(const MarkerReading& reading) {
  MarkerDetection detection;
  detection.family = reading.family;
  detection.id = reading.id;
  detection.corners = reading.corners;
  detection.center = reading.center;
  detection.residual = std::numeric_limits<double>::quiet_NaN();
  detection.deviations = std::numeric_limits<double>::quiet_NaN();
  detection.hamming = reading.hamming;
  detection.margin = reading.margin;
  return detection;
}

MarkerDetection toDetection(const MarkerObservation& observation, const Marker& marker) {
  MarkerDetection detection;
  detection.family = marker.family;
  detection.id = marker.id;
  detection.map_entry = observation.map_entry;
  detection.corners = observation.corners;
  detection.center = observation.center;
  detection.hamming = observation.hamming;
  detection.margin = observation.margin;
  return detection;
}

std::vector<MarkerReading> readViews(const TrackingTools& tools, std::vector<View> views,
                                     FrameResult* result) {
  Stopwatch step;
  std::vector<cv::Mat> images(views.size());
  const cv::Mat& panorama = tools.readable.get();
  forEachIndex(views.size(), tools.config.threads, 1,
               [&](std::size_t i) { images[i] = tools.reader.warper().warp(panorama, views[i]); });
  result->timings.warp += step.lap();
  std::vector<MarkerReading> readings = tools.reader.read(images, views);
  for (MarkerReading& reading : readings) reading.view += result->views.size();
  std::move(views.begin(), views.end(), std::back_inserter(result->views));
  std::move(images.begin(), images.end(), std::back_inserter(result->view_images));
  result->timings.decode += step.lap();
  return readings;
}

bool isPlaceKnown(const TrackingTools& tools, const MountedCamera& camera,
                  const PredictedMarker& predicted) {
  const TagPattern& pattern = tools.patterns.of(tools.map.markers[predicted.map_entry]);
  return std::max(predicted.tangential_margin, predicted.radial_margin) <=
         largestMargin(predicted, pattern, camera, tools.config.recognition);
}

std::optional<MarkerObservation> recognizePredicted(const TrackingTools& tools,
                                                    const cv::Mat& panorama,
                                                    const MountedCamera& camera,
                                                    const Pose& map_from_base,
                                                    const PredictedMarker& predicted) {
  const Marker& marker = tools.map.markers[predicted.map_entry];
  const auto recognition = recognize(panorama, marker, tools.patterns.of(marker), camera,
                                     map_from_base, predicted, tools.config.recognition);
  if (!recognition || !recognition->is_accepted) return std::nullopt;
  return MarkerObservation{predicted.map_entry, recognition->corners, recognition->center,
                           recognition->is_stretched ? 0.0 : predicted.shape_deviation};
}

std::optional<MarkerObservation> recognizeMarker(const TrackingTools& tools,
                                                 const cv::Mat& panorama,
                                                 const MountedCamera& camera, std::size_t entry,
                                                 const PoseEstimate& belief) {
  const auto predicted = predictMarker(tools.map, entry, camera, belief, tools.config.visibility);
  if (!predicted) return std::nullopt;
  return recognizePredicted(tools, panorama, camera, belief.pose, *predicted);
}

std::optional<Pose> otherPose(const TrackingTools& tools, const Marker& marker,
                              const MountedCamera& camera, const Pose& map_from_base) {
  return tools.config.motion.isOnFloor()
             ? mirroredPose(marker, camera, map_from_base)
             : std::optional(flippedPose(marker, camera, map_from_base));
}

std::optional<PhotometricFit> alignWithPixels(const TrackingTools& tools, const cv::Mat& panorama,
                                              const MountedCamera& camera,
                                              const std::vector<std::size_t>& entries,
                                              const Pose& initial, const PosePrior& prior) {
  const PhotometricConfig& config = tools.config.estimation.photometric;
  if (tools.config.estimation.kind != EstimatorKind::kPhotometric) return std::nullopt;
  const auto from = [&](const Pose& start) {
    return refinePhotometrically(panorama, tools.map, camera, tools.patterns, entries, start, prior,
                                 config, tools.config.threads, tools.lasting_excess);
  };
  std::optional<PhotometricFit> fit = from(initial);
  if (entries.size() > 1) return fit;

  // A single marker may look almost the same from two sides.
  const Marker& marker = tools.map.markers[entries.front()];
  const Pose& seen_from = fit ? fit->map_from_base.pose : initial;
  const auto mirrored = otherPose(tools, marker, camera, seen_from);
  std::optional<PhotometricFit> other = mirrored ? from(*mirrored) : std::nullopt;
  if (!fit) std::swap(fit, other);
  if (!fit) return std::nullopt;
  if (!other) return fit;
  const PhotometricFit& sharper = other->noise < fit->noise ? *other : *fit;
  const auto misfit = [&](const PhotometricFit& optimum) {
    const double sum = photometricMisfit(panorama, tools.map, camera, tools.patterns, entries,
                                         optimum.map_from_base.pose, sharper, config);
    const PoseVector off = prior.errorOf(optimum.map_from_base.pose);
    return sum + off.dot(prior.information * off);
  };
  fit->map_from_base =
      mixture(fit->map_from_base, misfit(*fit), other->map_from_base, misfit(*other));
  fit->surprise = 1.0;
  fit->excess = 1.0;
  return fit;
}

PoseEstimate standingOnCorners(const PoseEstimate& pose, std::size_t markers,
                               const LocalizerConfig& config) {
  constexpr std::size_t kFew = 2;
  const ReprojectionConfig& reprojection = config.estimation.reprojection;
  const double ratio = reprojection.poor_corner_noise / reprojection.corner_noise;
  const bool was_to_be_aligned = config.estimation.kind == EstimatorKind::kPhotometric;
  PoseEstimate standing = pose;
  if (was_to_be_aligned && markers <= kFew && ratio > 1.0) {
    standing.covariance = pose.shared + ratio * ratio * (pose.covariance - pose.shared);
  }
  return standing;
}

}  // namespace omnitag
