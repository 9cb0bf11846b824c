#include <algorithm>
#include <utility>

#include "common/stopwatch.h"
#include "localization/branch.h"
#include "localization/frame_search.h"
#include "localization/frame_steps.h"
#include "localization/glance_search.h"
#include "localization/localizer_impl.h"
#include "localization/pose_confirmation.h"
#include "localization/relocalization.h"

namespace omnitag {
namespace {

/// Without a prediction, nothing but a third marker would reveal that one of two is shaded or
/// partly covered: a pose to start from should not look too certain.
PoseEstimate modest(const PoseEstimate& pose, const FrameResult& result) {
  constexpr int kFew = 2;
  constexpr double kDoubt = 2.0;
  const double rise = result.acceptedMarkers() <= kFew ? kDoubt : 1.0;
  return {pose.pose, rise * rise * pose.covariance, rise * rise * pose.shared};
}

/// The entries of map markers that were read where the predicted pose projects them.
std::vector<std::size_t> entriesWherePredicted(const TrackingTools& tools,
                                               const MountedCamera& camera,
                                               const PoseEstimate& predicted,
                                               const FrameResult& result) {
  std::vector<std::size_t> entries;
  const PosePrior prior = PosePrior::about(predicted);
  for (const MarkerDetection& detection : result.detections) {
    if (detection.accepted) continue;
    for (const std::size_t entry : entriesOf(tools.map, detection.family, detection.id)) {
      const MarkerObservation observation{entry, detection.corners, detection.center};
      if (agreesWithPrior(tools.map, tools.config.estimation, camera, observation, prior))
        entries.push_back(entry);
    }
  }
  return entries;
}

/// A pose that the readings of a look all around give only together with markers that are
/// recognized from there; these are then in the result.
std::optional<PoseEstimate> confirmAround(const TrackingTools& tools,
                                          const std::vector<MarkerReading>& readings,
                                          const Frame& frame, const MountedCamera& camera,
                                          FrameResult* result) {
  const auto areTwo = [](const FrameResult& seen) { return seen.acceptedMarkers() >= 2; };
  auto seen = confirm({readings, result->views, result->view_images}, areTwo, tools, frame, camera,
                      &result->timings);
  if (!seen) return std::nullopt;
  seen->explored = std::move(result->explored);
  seen->timings = result->timings;
  *result = std::move(*seen);
  return result->map_from_base;
}

/// The branch of a robot that was lost, or is where it was expected after all.
Branch foundAt(const PoseEstimate& pose, FrameResult found, bool is_expected, const Frame& frame,
               Branch branch) {
  branch.is_of_search = true;
  branch.result = std::move(found);
  branch.result.map_from_base = pose;
  branch.result.mode = is_expected ? Mode::kTracking : Mode::kFound;
  Hypothesis& hypothesis = branch.hypothesis;
  hypothesis.is_lost = false;
  hypothesis.seen_stamp = frame.stamp;
  if (is_expected) {
    hypothesis.motion.correct(pose);
  } else {
    hypothesis.motion.reset(pose, frame.stamp, frame.odom_from_base);
    hypothesis.restart(std::nullopt);
  }
  return branch;
}

}  // namespace

std::vector<Branch> Localizer::Impl::lookFor(const Frame& frame, const MountedCamera& camera,
                                             Branch branch,
                                             const std::optional<PoseEstimate>& predicted,
                                             bool is_refuted) {
  const Hypothesis before = branch.hypothesis;
  const TrackingTools tools = trackingTools(frame, before);
  FrameResult result = branch.result;
  const std::optional<PoseEstimate> pose = search(tools, frame, camera, predicted, &result);
  if (!pose) {
    if (predicted) carryOn(*predicted, is_refuted, map_, &result);
    setResiduals(tools, camera, &result);
    branch.result = std::move(result);
    branch.hypothesis.is_lost = !predicted;
    return {std::move(branch)};
  }
  std::vector<std::size_t> entries = acceptedEntries(result);
  const bool are_moved = std::all_of(entries.begin(), entries.end(), [&before](std::size_t entry) {
    return before.memory.isElsewhere(entry);
  });
  const bool is_expected = predicted && !are_moved && agree(*predicted, *pose);
  if (!is_expected && predicted) {
    branch = stayingAt(*predicted, result, map_, config_.estimation, camera, std::move(branch));
    for (const std::size_t entry : entriesWherePredicted(tools, camera, *predicted, result)) {
      result.elsewhere.push_back(entry);
    }
    result.remark = howFarOff(pose->pose, predicted->pose);
    result.mode = Mode::kFound;
    std::vector<Branch> branches =
        branchesOf(childrenAt(pose->pose, frame, camera, before, branch, evidence_), *pose,
                   std::move(result), frame);
    for (Branch& child : branches) child.is_of_search = true;
    branches.push_back(std::move(branch));
    return branches;
  }
  // If nothing else is in view, the robot may just as well be elsewhere.
  if (!predicted && are_moved) {
    result.elsewhere = std::move(entries);
    withhold(map_, &result);
    branch.result = std::move(result);
    branch.hypothesis.is_lost = true;
    return {std::move(branch)};
  }
  return {foundAt(*pose, std::move(result), is_expected, frame, std::move(branch))};
}

std::optional<PoseEstimate> Localizer::Impl::search(const TrackingTools& tools, const Frame& frame,
                                                    const MountedCamera& camera,
                                                    const std::optional<PoseEstimate>& predicted,
                                                    FrameResult* result) {
  const auto toldBy = [&](const PoseEstimate& seen) {
    return predicted && agree(*predicted, seen) ? seen : modest(seen, *result);
  };
  if (const auto seen = glance(tools, frame, camera, result)) return toldBy(*seen);
  const std::vector<MarkerReading> readings = lookAround(tools, camera, result);
  Stopwatch step;
  const Relocalization found =
      relocalize(map_, camera, readings, standing_, config_.estimation, config_.relocalization);
  result->timings.solve += step.lap();
  if (!found.map_from_base && config_.estimation.kind == EstimatorKind::kPhotometric) {
    if (const auto seen = confirmAround(tools, readings, frame, camera, result)) {
      return toldBy(*seen);
    }
  }
  const std::vector<std::size_t> explaining = addDetections(tools, readings, found, result);
  if (!found.map_from_base) {
    if (!predicted) result->remark = found.reason;
    return std::nullopt;
  }
  const bool is_expected = predicted && agree(*predicted, *found.map_from_base);
  const bool is_sure = is_expected || explaining.size() >= 2;
  // A single marker may hang elsewhere than the map says, and its pixels cannot show that.
  if (!is_sure) return found.map_from_base;
  step.lap();
  PoseEstimate pose = *found.map_from_base;
  const PosePrior prior = is_expected ? PosePrior::about(*predicted) : standing_;
  const auto aligned = alignWithPixels(tools, frame.image, camera, explaining, pose.pose, prior);
  // If the two contradict each other, something covers a marker, or the map is too inexact to align
  // pixels with: corners tolerate more.
  const bool fits = aligned && agree(aligned->map_from_base, pose);
  pose = fits ? aligned->map_from_base : standingOnCorners(pose, explaining.size(), config_);
  result->imaging_error = fits ? aligned->imaging_error : found.imaging_error;
  result->timings.solve += step.lap();
  pose = withUndecoded(tools, frame, camera, pose, explaining, prior, result);
  result->map_from_base = pose;
  setResiduals(tools, camera, result);
  return is_expected ? pose : modest(pose, *result);
}

}  // namespace omnitag
