#include "frame_tracker.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "omnitag/common/angle.h"
#include "omnitag/common/parallel.h"
#include "omnitag/common/stopwatch.h"
#include "omnitag/localization/marker_pose.h"
#include "omnitag/marker/marker_association.h"

namespace omnitag {
namespace {

/// Markers that make a prediction sharp enough to find all others easily.
constexpr std::size_t kFirst = 2;

/// Markers that leave no doubt about the pose when all of them are where they should be.
constexpr std::size_t kEnough = 3;

/// Of a prediction that is too vague to recognize markers, how many are decoded at first.
constexpr std::size_t kAnchors = 4;

/// Pixels of a view that is decoded at most.
constexpr double kAnySize = std::numeric_limits<double>::infinity();

/// The same where the prediction is in doubt: a look at the panorama itself must not cost less.
double largestInDoubt(const cv::Mat& panorama) {
  constexpr double kShareOfSides = 0.25;
  return kShareOfSides * panorama.cols * kShareOfSides * panorama.rows;
}

/// Mean and covariance of a pose of which two estimates are possible, each with its misfit (twice
/// the negative log-likelihood).
PoseEstimate mixture(const PoseEstimate& a, double misfit_a, const PoseEstimate& b,
                     double misfit_b) {
  const double ratio = std::exp(0.5 * std::clamp(misfit_a - misfit_b, -100.0, 100.0)) *
                       std::sqrt(b.covariance.determinant() / a.covariance.determinant());
  const double share = ratio / (1.0 + ratio);
  const Eigen::Vector3d apart = difference(b.pose, a.pose);
  PoseEstimate mean;
  mean.pose = {a.pose.x + share * apart.x(), a.pose.y + share * apart.y(),
               normalizeAngle(a.pose.yaw + share * apart.z())};
  mean.covariance = (1.0 - share) * a.covariance + share * b.covariance +
                    share * (1.0 - share) * apart * apart.transpose();
  return mean;
}

}  // namespace

MarkerDetection toDetection(const MarkerReading& reading) {
  MarkerDetection detection;
  detection.family = reading.family;
  detection.id = reading.id;
  detection.corners = reading.corners;
  detection.center = reading.center;
  detection.residual = std::numeric_limits<double>::quiet_NaN();
  return detection;
}

MarkerDetection toDetection(const MarkerObservation& observation, const Marker& marker) {
  MarkerDetection detection;
  detection.family = marker.family;
  detection.id = marker.id;
  detection.map_entry = observation.map_entry;
  detection.corners = observation.corners;
  detection.center = observation.center;
  return detection;
}

std::vector<MarkerReading> readViews(const TrackingTools& tools, const cv::Mat& panorama,
                                     std::vector<View> views, FrameResult* result) {
  Stopwatch step;
  const std::size_t first = result->views.size();
  result->view_images.resize(first + views.size());
  forEachIndex(views.size(), tools.config.threads, 1, [&](std::size_t i) {
    result->view_images[first + i] = tools.reader.warper().warp(panorama, views[i]);
  });
  std::move(views.begin(), views.end(), std::back_inserter(result->views));
  result->timings.warp += step.lap();
  std::vector<MarkerReading> readings;
  for (std::size_t v = first; v < result->views.size(); ++v) {
    for (MarkerReading& reading : tools.reader.read(result->view_images[v], result->views[v])) {
      reading.view = v;
      readings.push_back(std::move(reading));
    }
  }
  result->timings.decode += step.lap();
  return readings;
}

std::optional<MarkerObservation> recognizeMarker(const TrackingTools& tools,
                                                 const cv::Mat& panorama,
                                                 const MountedCamera& camera, std::size_t entry,
                                                 const PoseEstimate& belief) {
  const auto predicted = predictMarker(tools.map, entry, camera, belief, tools.config.visibility);
  if (!predicted) return std::nullopt;
  const Marker& marker = tools.map.markers[entry];
  const auto recognition =
      recognize(panorama, marker, tools.patterns.of(marker), camera, belief.pose, *predicted,
                tools.config.estimation.photometric.blur, tools.config.recognition);
  if (!recognition || !recognition->isAccepted()) return std::nullopt;
  return MarkerObservation{entry, recognition->corners, recognition->center};
}

double residualLimit(const MarkerObservation& recognized, const LocalizerConfig& config) {
  constexpr double kHalfModule = 1.0 / 16.0;  // of the edge
  return std::max(config.estimation.max_residual, kHalfModule * meanEdge(recognized.corners));
}

std::optional<PoseEstimate> alignWithPixels(const TrackingTools& tools, const cv::Mat& panorama,
                                            const MountedCamera& camera,
                                            const std::vector<std::size_t>& entries,
                                            const Pose2& initial,
                                            const std::optional<PoseEstimate>& prior) {
  const PhotometricConfig& config = tools.config.estimation.photometric;
  if (tools.config.estimation.kind != EstimatorKind::kPhotometric) return std::nullopt;
  const auto from = [&](const Pose2& start) {
    return refinePhotometrically(panorama, tools.map, camera, tools.patterns, entries, start, prior,
                                 config, tools.config.threads);
  };
  std::optional<PhotometricFit> fit = from(initial);
  if (entries.size() > 1) return fit ? std::optional(fit->map_from_base) : std::nullopt;

  // A single marker may look almost the same from two sides.
  const Marker& marker = tools.map.markers[entries.front()];
  const auto mirrored = mirroredPose(marker, camera, fit ? fit->map_from_base.pose : initial);
  std::optional<PhotometricFit> other = mirrored ? from(*mirrored) : std::nullopt;
  if (!fit) std::swap(fit, other);
  if (!fit) return std::nullopt;
  if (!other) return fit->map_from_base;
  const PhotometricFit& sharper = other->noise < fit->noise ? *other : *fit;
  const auto misfit = [&](const PhotometricFit& optimum) {
    double sum = photometricMisfit(panorama, tools.map, camera, tools.patterns, entries,
                                   optimum.map_from_base.pose, sharper, config);
    if (prior) {
      const Eigen::Vector3d off = difference(optimum.map_from_base.pose, prior->pose);
      sum += off.dot(prior->covariance.inverse() * off);
    }
    return sum;
  };
  return mixture(fit->map_from_base, misfit(*fit), other->map_from_base, misfit(*other));
}

PoseEstimate standingOnCorners(const PoseEstimate& pose, std::size_t markers,
                               const LocalizerConfig& config) {
  constexpr std::size_t kFew = 2;
  const double ratio =
      config.relocalization.corner_noise / config.estimation.reprojection.corner_noise;
  const bool was_to_be_aligned = config.estimation.kind == EstimatorKind::kPhotometric;
  PoseEstimate standing = pose;
  if (was_to_be_aligned && markers <= kFew && ratio > 1.0) standing.covariance *= ratio * ratio;
  return standing;
}

FrameTracker::FrameTracker(const TrackingTools& tools, const Frame& frame,
                           const MountedCamera& camera, const PoseEstimate& predicted,
                           FrameResult* result)
    : tools_(tools),
      frame_(frame),
      camera_(camera),
      predicted_(predicted),
      result_(result),
      sightings_(result->predicted.size()) {}

std::optional<PoseEstimate> FrameTracker::track(std::optional<std::size_t> glance) {
  const bool recognizes = tools_.config.estimation.kind == EstimatorKind::kPhotometric;
  if (recognizes) {
    // The first ones make it easy to find the others.
    recognize(predicted_, kFirst);
    if (found() < kFirst) {
      std::vector<std::size_t> anchors = undecoded();
      anchors.resize(std::min(anchors.size(), kAnchors));
      decode(anchors, glance ? kAnySize : largestInDoubt(frame_.image));
    }
    solve();
    if (solution_) {
      recognizeAll(solution_->map_from_base);
      solve();
    }
  }
  std::vector<std::size_t> rest = undecoded();
  if (recognizes && !glance) rest.clear();
  if (glance && found() >= kEnough && !rest.empty()) rest = {rest[*glance % rest.size()]};
  if (!rest.empty()) {
    decode(rest, kAnySize);
    solve();
  }
  Stopwatch step;
  if (solution_) align();
  result_->timings.solve += step.lap();
  report();
  if (frame_.wants_views) addViews();
  return solution_ ? std::optional(solution_->map_from_base) : std::nullopt;
}

void FrameTracker::recognize(const PoseEstimate& belief, std::size_t enough) {
  Stopwatch step;
  for (const std::size_t target : missing()) {
    if (found() >= enough) break;
    sightings_[target].observation = recognizeOne(target, belief);
  }
  result_->timings.recognize += step.lap();
}

void FrameTracker::recognizeAll(const PoseEstimate& belief) {
  Stopwatch step;
  const std::vector<std::size_t> targets = missing();
  constexpr std::size_t kWorthAThread = 2;
  forEachIndex(targets.size(), tools_.config.threads, kWorthAThread, [&](std::size_t i) {
    sightings_[targets[i]].observation = recognizeOne(targets[i], belief);
  });
  result_->timings.recognize += step.lap();
}

std::optional<MarkerObservation> FrameTracker::recognizeOne(std::size_t target,
                                                            const PoseEstimate& belief) const {
  return recognizeMarker(tools_, frame_.image, camera_, result_->predicted[target].map_entry,
                         belief);
}

std::vector<std::size_t> FrameTracker::missing() const {
  std::vector<std::size_t> targets;
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    if (!sightings_[i].observation) targets.push_back(i);
  }
  std::stable_sort(targets.begin(), targets.end(), [this](std::size_t a, std::size_t b) {
    return meanEdge(result_->predicted[a].corners) > meanEdge(result_->predicted[b].corners);
  });
  return targets;
}

std::vector<std::size_t> FrameTracker::undecoded() const {
  std::vector<std::size_t> targets = missing();
  const auto isHopeless = [this](std::size_t target) {
    return sightings_[target].was_decoded || longestEdge(result_->predicted[target].corners) <
                                                 tools_.config.visibility.min_decodable_edge_pixels;
  };
  targets.erase(std::remove_if(targets.begin(), targets.end(), isHopeless), targets.end());
  return targets;
}

std::size_t FrameTracker::found() const {
  return static_cast<std::size_t>(
      std::count_if(sightings_.begin(), sightings_.end(),
                    [](const Sighting& sighting) { return sighting.observation.has_value(); }));
}

void FrameTracker::decode(const std::vector<std::size_t>& targets, double max_pixels) {
  Stopwatch step;
  std::vector<View> views = viewsOf(targets);
  views.erase(
      std::remove_if(views.begin(), views.end(),
                     [max_pixels](const View& view) { return view.size.area() > max_pixels; }),
      views.end());
  for (const View& view : views) {
    for (const std::size_t target : view.targets) sightings_[target].was_decoded = true;
  }
  result_->timings.predict += step.lap();
  // Views overlap: what one of them shows may have been expected in another.
  std::vector<std::size_t> all(result_->predicted.size());
  std::iota(all.begin(), all.end(), 0U);
  for (const MarkerReading& reading : readViews(tools_, frame_.image, std::move(views), result_)) {
    const Association association =
        associate(reading, result_->predicted, all, tools_.map, tools_.config.association);
    if (association.prediction) {
      Sighting& sighting = sightings_[*association.prediction];
      const std::size_t entry = result_->predicted[*association.prediction].map_entry;
      if (!sighting.observation) sighting.observation = {entry, reading.corners, reading.center};
    } else {
      strangers_.push_back(toDetection(reading));
      strangers_.back().reason = association.reason;
    }
  }
}

void FrameTracker::solve() {
  Stopwatch step;
  std::vector<MarkerObservation> observations;
  observed_.clear();
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    if (!sightings_[i].observation) continue;
    observations.push_back(*sightings_[i].observation);
    observed_.push_back(i);
  }
  solution_ = estimatePose(tools_.map, camera_, observations, predicted_, tools_.config.estimation);
  result_->timings.solve += step.lap();
}

void FrameTracker::align() {
  std::vector<std::size_t> entries;
  std::vector<MarkerObservation> observations;
  for (std::size_t k = 0; k < observed_.size(); ++k) {
    observations.push_back(*sightings_[observed_[k]].observation);
    if (solution_->used[k]) entries.push_back(observations.back().map_entry);
  }
  const auto aligned = alignWithPixels(tools_, frame_.image, camera_, entries,
                                       solution_->map_from_base.pose, predicted_);
  if (!aligned) {
    solution_->map_from_base =
        standingOnCorners(solution_->map_from_base, entries.size(), tools_.config);
    return;
  }
  std::vector<double> residuals =
      reprojectionResiduals(tools_.map, camera_, observations, aligned->pose);
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    if (solution_->used[k] && residuals[k] > residualLimit(observations[k], tools_.config)) return;
  }
  solution_->map_from_base = *aligned;
  solution_->residuals = std::move(residuals);
}

void FrameTracker::report() {
  for (std::size_t k = 0; k < observed_.size(); ++k) {
    const MarkerObservation& observation = *sightings_[observed_[k]].observation;
    const Marker& marker = tools_.map.markers[observation.map_entry];
    MarkerDetection detection = toDetection(observation, marker);
    detection.accepted = solution_ && solution_->used[k];
    detection.residual =
        solution_ ? solution_->residuals[k] : std::numeric_limits<double>::quiet_NaN();
    if (!detection.accepted) {
      detection.reason = solution_ ? "disagrees with the other markers" : "no pose agrees with it";
    }
    result_->detections.push_back(std::move(detection));
  }
  std::move(strangers_.begin(), strangers_.end(), std::back_inserter(result_->detections));
}

void FrameTracker::addViews() {
  std::vector<std::size_t> targets;
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    if (!sightings_[i].was_decoded) targets.push_back(i);
  }
  for (View& view : viewsOf(targets)) {
    result_->view_images.push_back(tools_.reader.warper().warp(frame_.image, view));
    result_->views.push_back(std::move(view));
  }
}

std::vector<View> FrameTracker::viewsOf(const std::vector<std::size_t>& targets) const {
  std::vector<ViewTarget> view_targets;
  view_targets.reserve(targets.size());
  for (const std::size_t target : targets) {
    view_targets.push_back(viewTarget(result_->predicted[target], camera_.model()));
  }
  std::vector<View> views =
      planViews(view_targets, tools_.reader.warper().table(), camera_.model().imagePlane().scale(),
                camera_.axisUp(), tools_.config.view);
  for (View& view : views) {
    for (std::size_t& target : view.targets) target = targets[target];
  }
  return views;
}

}  // namespace omnitag
