#include <algorithm>
#include <utility>

#include "common/stopwatch.h"
#include "common/symmetric_matrix.h"
#include "localization/belief.h"
#include "localization/camera_state.h"
#include "localization/frame_search.h"
#include "localization/frame_steps.h"
#include "localization/frame_tracker.h"
#include "localization/localizer_impl.h"
#include "localization/relocalization.h"
#include "localization/reprojection.h"

namespace omnitag {
namespace {

/// Standard deviations: how far the pose from the markers alone may be off the prediction. Robots
/// accelerate and slip more than the motion model says, but not that much.
constexpr double kMaxDeviations = 6.0;

/// This few markers may be nearly where they were although the robot was carried toward them or
/// away.
constexpr int kFew = 2;

/// m and rad: standard deviation of a swaying robot's apparent motion, whatever its odometry says.
constexpr double kSway = 2e-3;

/// s: time until a pose based on few markers is doubted again, which costs a look all around.
constexpr double kDoubtPeriod = 0.25;

/// At most this many other poses that a frame's markers indicate are followed.
constexpr std::size_t kMostAlternatives = 2;

/// The pose from markers as a prediction for finding the same markers: it must count less than they
/// do.
PoseEstimate predictionFrom(const PoseEstimate& alternative) {
  constexpr double kDoubt = 3.0;
  constexpr double kLeast = 1e-3;  // m and rad
  PoseEstimate prediction = alternative;
  prediction.covariance *= kDoubt * kDoubt;
  prediction.covariance.diagonal().array() += kLeast * kLeast;
  return prediction;
}

/// Whether markers lead so far from a given pose that they more likely hang elsewhere.
bool isFarFromStart(const Branch& branch, const Hypothesis& before) {
  const Hypothesis& hypothesis = branch.hypothesis;
  return hypothesis.start && before.memory.countInPlace() == 0 && !hypothesis.isWithinStart();
}

}  // namespace

std::vector<Branch> Localizer::Impl::track(const Frame& frame, const MountedCamera& camera,
                                           const std::vector<PoseEstimate>& predicted) {
  std::vector<Branch> branches;
  std::vector<MarkerObservation> seen;
  bool is_likeliest = true;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    if (hypotheses_[i].is_lost) {
      branches.push_back({hypotheses_[i], emptyResult(frame, config_)});
      continue;
    }
    for (Branch& branch : track(frame, camera, hypotheses_[i], predicted[i], is_likeliest, &seen)) {
      branches.push_back(std::move(branch));
    }
    is_likeliest = false;
  }
  return branches;
}

std::vector<Branch> Localizer::Impl::track(const Frame& frame, const MountedCamera& camera,
                                           const Hypothesis& before, const PoseEstimate& predicted,
                                           bool is_likeliest,
                                           std::vector<MarkerObservation>* seen) {
  Branch branch{before, emptyResult(frame, config_)};
  Hypothesis& hypothesis = branch.hypothesis;
  FrameResult& result = branch.result;
  const TrackingTools tools = trackingTools(frame, before);
  Stopwatch step;
  result.predicted = predictMarkers(map_, index_, camera, predicted, config_.visibility);
  result.timings.predict += step.lap();
  std::vector<PoseEstimate> others;
  const std::optional<PoseEstimate> pose =
      followMarkers(tools, frame, camera, predicted, is_likeliest, &result, seen, &others);
  // A camera that looks at a bare wall, or is covered, leaves the search to another.
  const bool is_blind = !pose && contradictions(result, map_) == 0 && isSeenByAnother(frame);
  const auto lookForIt = [&](bool is_refuted) -> std::vector<Branch> {
    if (is_likeliest && !is_blind)
      return lookFor(frame, camera, std::move(branch), predicted, is_refuted);
    carryOn(predicted, is_refuted, map_, &result);
    return {std::move(branch)};
  };
  // If most of the readings contradict, the prediction itself is in doubt.
  if (!pose || contradictions(result, map_) > result.acceptedMarkers()) return lookForIt(false);
  if (!markersAgree(camera, predicted, pose->pose, result)) return lookForIt(true);
  if (isElsewhere(tools, frame, camera, before, *pose, &result)) return lookForIt(true);
  const PoseEstimate corrected = withLag(frame, predicted, *pose, is_likeliest);
  if (hypothesis.memory.countInPlace() == 0) {
    hypothesis.start_error = corrected.pose.toIsometry() * predicted.pose.toIsometry().inverse() *
                             hypothesis.start_error;
  }
  hypothesis.motion.correct(corrected);
  hypothesis.seen_stamp = frame.stamp;
  result.mode = Mode::kTracking;
  result.map_from_base = corrected;

  std::vector<Branch> branches;
  others.resize(std::min(others.size(), kMostAlternatives));
  for (const PoseEstimate& other : others) {
    for (Branch& child : alternativesAt(other, frame, camera, before, branch, *seen)) {
      branches.push_back(std::move(child));
    }
  }
  if (isFarFromStart(branch, before)) {
    branches.push_back(
        stayingAt(predicted, result, map_, config_.estimation, camera, {before, {}}));
  }
  branches.insert(branches.begin(), std::move(branch));
  return branches;
}

std::vector<Branch> Localizer::Impl::alternativesAt(const PoseEstimate& pose, const Frame& frame,
                                                    const MountedCamera& camera,
                                                    const Hypothesis& before, const Branch& branch,
                                                    const std::vector<MarkerObservation>& seen) {
  const MountedCamera blurred = camera.withBlur(branch.result.blur);
  const PoseEstimate about = predictionFrom(pose);
  std::vector<Hypothesis> children =
      childrenAt(pose.pose, frame, camera, before, branch, evidence_);
  FrameResult result = emptyResult(frame, config_);
  result.predicted = predictMarkers(map_, index_, blurred, about, config_.visibility);
  const TrackingTools tools = trackingTools(frame, children.back());
  FrameTracker tracker(tools, frame, blurred, about, true, &result);
  tracker.takeSeen(seen);
  const auto seen_from = tracker.track();
  if (!seen_from || result.acceptedMarkers() == 0) return {};
  result.blur = branch.result.blur;
  result.mode = Mode::kTracking;
  result.remark = howFarOff(seen_from->pose, branch.result.map_from_base->pose);
  return branchesOf(std::move(children), *seen_from, std::move(result), frame);
}

std::optional<PoseEstimate> Localizer::Impl::followMarkers(
    const TrackingTools& tools, const Frame& frame, const MountedCamera& camera,
    const PoseEstimate& predicted, bool learns, FrameResult* result,
    std::vector<MarkerObservation>* seen, std::vector<PoseEstimate>* alternatives) {
  const CameraModel& model = *stateOf(frame).model;
  BlurFilter& filter = stateOf(frame).knowledge.blur;
  const FrameResult before = *result;
  MountedCamera blurred = camera;
  std::optional<PoseEstimate> pose;
  // Markers that are blurred differently than expected are looked for again.
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    FrameTracker tracker(tools, frame, blurred, predicted, true, result);
    if (!learns) tracker.takeSeen(*seen);
    pose = tracker.track();
    *seen = tracker.seen();
    *alternatives = tracker.alternatives();
    if (!result->blur_equations) break;
    const ImageBlur blur = filter.after(*result->blur_equations, blurred.blur());
    if (areAlike(blur, blurred.blur(), model.rimPixels())) break;
    if (round == kRounds - 1) break;
    const Timings timings = result->timings;
    *result = before;
    result->timings = timings;
    blurred = camera.withBlur(blur);
  }
  // If markers disagree about the pose, their blur is not reliable.
  const bool is_certain = alternatives->empty() && hypotheses_.size() == 1;
  if (result->blur_equations && learns && is_certain)
    filter.take(*result->blur_equations, blurred.blur());
  result->blur = learns ? filter.blur() : blurred.blur();
  return pose;
}

PoseEstimate Localizer::Impl::withLag(const Frame& frame, const PoseEstimate& predicted,
                                      const PoseEstimate& pose, bool learns) {
  PoseEstimate lagging = pose;
  if (!frame.velocity || !frame.odom_from_base) return lagging;
  const double innovation = difference(pose.pose, predicted.pose)[2];
  // Several cameras may each lag by a different time, and all of them would influence the pose.
  if (learns && cameras_.size() == 1) image_lag_.add(innovation, *frame.velocity, was_tracked_);
  if (const std::optional<double> lag = image_lag_.lag()) {
    const PoseMatrix covariance = covarianceOfLag(*lag, *frame.velocity);
    lagging.covariance += covariance;
    lagging.shared += covariance;
  }
  return lagging;
}

bool Localizer::Impl::markersAgree(const MountedCamera& camera, const PoseEstimate& predicted,
                                   const Pose& solution, const FrameResult& result) const {
  // If the robot was carried toward one or two markers, or away from them, they appear nearly where
  // they were.
  const auto isFarOff = [this](const MarkerDetection& detection) {
    return detection.accepted && detection.deviations > config_.relocalization.max_misfit_of_one;
  };
  const auto& detections = result.detections;
  if (result.acceptedMarkers() <= kFew &&
      std::any_of(detections.begin(), detections.end(), isFarOff)) {
    return false;
  }
  const std::vector<MarkerObservation> observations = acceptedObservations(result);
  if (observations.size() == 1) return true;
  const ReprojectionConfig& reprojection = config_.estimation.reprojection;
  const auto fit = refineFromAfar(map_, camera, observations, solution, standing_, reprojection);
  if (!fit) return true;
  const PoseVector apart = difference(fit->map_from_base.pose, predicted.pose);
  const PoseMatrix covariance =
      predicted.covariance + fit->map_from_base.covariance + kSway * kSway * PoseMatrix::Identity();
  return mahalanobisSquare(apart, covariance) <= kMaxDeviations * kMaxDeviations;
}

bool Localizer::Impl::isElsewhere(const TrackingTools& tools, const Frame& frame,
                                  const MountedCamera& camera, const Hypothesis& hypothesis,
                                  const PoseEstimate& tracked, FrameResult* result) {
  const double last = std::min(hypothesis.seen_stamp,
                               stateOf(frame).knowledge.last_stamp.value_or(hypothesis.seen_stamp));
  const auto lost =
      std::count_if(result->missed.begin(), result->missed.end(),
                    [&](std::size_t entry) { return hypothesis.memory.wasSeenSince(entry, last); });
  const bool is_weak = result->acceptedMarkers() <= kFew && lost > 0;
  if (!is_weak || frame.stamp < next_doubt_) return false;
  next_doubt_ = frame.stamp + kDoubtPeriod;
  FrameResult around;
  around.timings = result->timings;
  const std::vector<MarkerReading> readings = lookAround(tools, camera, &around);
  Stopwatch step;
  const Relocalization found =
      relocalize(map_, camera, readings, standing_, config_.estimation, config_.relocalization);
  result->timings = around.timings;
  result->timings.solve += step.lap();
  result->explored = std::move(around.explored);
  const auto explained = std::count_if(found.entries.begin(), found.entries.end(),
                                       [](const auto& entry) { return entry.has_value(); });
  return found.map_from_base && explained >= 2 && !agree(*found.map_from_base, tracked);
}

}  // namespace omnitag
