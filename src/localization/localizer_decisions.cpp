#include <algorithm>
#include <string>
#include <utility>

#include "frame_search.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {

Verdict Localizer::weigh(const Frame& frame, const Pose& expected, const Pose& found,
                         const std::vector<std::size_t>& for_expected,
                         const FrameResult& result) const {
  Contradiction contradiction{
      expected, expected, found, acceptedEntries(result), for_expected, {}, !!frame.odom_from_base};
  const auto isShown = [&](std::size_t entry) {
    return std::any_of(
        result.detections.begin(), result.detections.end(),
        [entry](const MarkerDetection& detection) { return detection.map_entry == entry; });
  };
  for (const std::size_t entry : result.missed) {
    if (!isShown(entry)) contradiction.missed.push_back(entry);
  }
  return evidence_.weigh(contradiction, start_);
}

std::vector<std::size_t> Localizer::entriesWherePredicted(const MountedCamera& camera,
                                                          const PoseEstimate& predicted,
                                                          const FrameResult& result) {
  std::vector<std::size_t> entries;
  const PosePrior prior = PosePrior::about(predicted);
  const TrackingTools tools = trackingTools();
  for (const MarkerDetection& detection : result.detections) {
    if (detection.accepted) continue;
    for (const std::size_t entry : entriesOf(map_, detection.family, detection.id)) {
      const MarkerObservation observation{entry, detection.corners, detection.center};
      if (agreesWithPrior(tools, camera, observation, prior)) entries.push_back(entry);
    }
  }
  return entries;
}

void Localizer::decide(const PoseEstimate& pose, const Frame& frame, const MountedCamera& camera,
                       const std::optional<PoseEstimate>& predicted, bool is_expected,
                       FrameResult* result) {
  std::vector<std::size_t> entries = acceptedEntries(*result);
  const bool is_group = entries.size() >= 2;
  if (is_expected || !is_group) return settle(pose, frame, predicted, is_expected, result);
  if (!predicted) {
    // Where nothing else is in view, the robot may as well be elsewhere.
    const bool is_moved = std::all_of(entries.begin(), entries.end(), [this](std::size_t entry) {
      return memory_.elsewhere(entry) != nullptr;
    });
    if (!is_moved) return settle(pose, frame, predicted, is_expected, result);
    result->elsewhere = std::move(entries);
    return withhold(result);
  }
  const Verdict verdict = weigh(frame, predicted->pose, pose.pose,
                                entriesWherePredicted(camera, *predicted, *result), *result);
  if (verdict == Verdict::kFound) {
    memory_.forgetPlaces();
    return settle(pose, frame, predicted, is_expected, result);
  }
  result->elsewhere = std::move(entries);
  result->is_open = verdict == Verdict::kOpen;
  result->map_from_base = predicted;
  result->mode = Mode::kDeadReckoning;
  rejectAccepted(kElsewhere, result);
}

void Localizer::remember(const MountedCamera& camera, const FrameResult& result) {
  if (!result.map_from_base) return;
  const Pose& pose = result.map_from_base->pose;
  const MountedCamera seen_by = camera.withError(result.imaging_error);
  const auto sightingOf = [&](const MarkerDetection& detection) {
    return RememberedSighting{
        result.stamp, {*detection.map_entry, detection.corners, detection.center}, seen_by, pose};
  };
  for (const MarkerDetection& detection : result.detections) {
    if (!detection.map_entry) continue;
    const auto& elsewhere = result.elsewhere;
    if (detection.accepted) {
      if (!result.is_open) memory_.addSeen(sightingOf(detection));
    } else if (std::find(elsewhere.begin(), elsewhere.end(), *detection.map_entry) !=
               elsewhere.end()) {
      memory_.addElsewhere(sightingOf(detection), !result.is_open);
    }
  }
  const bool is_told = result.acceptedMarkers() > 0 && !result.is_open;
  const Eigen::Vector3d viewpoint = camera.mapFromCamera(pose).translation();
  for (const std::size_t entry : result.missed) {
    if (is_told) {
      memory_.addMissed(entry, viewpoint, result.stamp);
    } else {
      memory_.addLost(entry);
    }
  }
}

void Localizer::withhold(FrameResult* result) {
  std::string names;
  for (const std::size_t entry : result->elsewhere) {
    names += (names.empty() ? "" : ", ") + std::to_string(map_.markers[entry].id);
  }
  result->remark = "either markers " + names +
                   " hang elsewhere than the map says, or the robot is elsewhere than expected";
  result->mode = Mode::kSearching;
  result->map_from_base.reset();
  rejectAccepted("others contradict it", result);
}

}  // namespace omnitag
