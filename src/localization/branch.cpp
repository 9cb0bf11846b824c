#include "localization/branch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/format.h"
#include "localization/frame_search.h"
#include "localization/frame_steps.h"
#include "omnitag/common/angle.h"

namespace omnitag {

std::string howFarOff(const Pose& found, const Pose& expected) {
  const PoseVector off = difference(found, expected);
  return format("found %.2f m and %.1f degrees off where it was expected", off.head<2>().norm(),
                degrees(std::abs(off[2])));
}

FrameResult emptyResult(const Frame& frame, const LocalizerConfig& config) {
  FrameResult result;
  result.stamp = frame.stamp;
  result.is_on_floor = config.motion.isOnFloor();
  return result;
}

std::vector<Hypothesis> childrenAt(const Pose& pose, const Frame& frame,
                                   const MountedCamera& camera, const Hypothesis& before,
                                   const Branch& branch, const Evidence& evidence) {
  const Pose& expected = branch.result.map_from_base->pose;
  const Eigen::Isometry3d motion = pose.toIsometry() * expected.toIsometry().inverse();
  Hypothesis carried = before;
  carried.log_of_carried += evidence.logOfCarried(frame.odom_from_base.has_value());
  Hypothesis elsewhere = before;
  elsewhere.memory.moveBy(motion, evidence.contradiction());
  elsewhere.start_error = motion * branch.hypothesis.start_error;
  std::vector<Hypothesis> children{std::move(carried), std::move(elsewhere)};
  std::vector<RememberedSighting> group;
  for (const MarkerDetection& detection : branch.result.detections) {
    if (!detection.accepted) continue;
    RememberedSighting sighting = sightingOf(detection, branch.result, camera, pose);
    if (evidence.contradicts(sighting, Eigen::Isometry3d::Identity())) {
      group.push_back(std::move(sighting));
    }
  }
  if (group.empty()) return children;
  for (Hypothesis& child : children) child.memory.addGroup(group, motion.inverse());
  return children;
}

std::vector<Branch> branchesOf(std::vector<Hypothesis> children, const PoseEstimate& pose,
                               FrameResult result, const Frame& frame) {
  result.map_from_base = pose;
  std::vector<Branch> branches;
  for (Hypothesis& child : children) {
    child.motion.reset(pose, frame.stamp, frame.odom_from_base);
    child.seen_stamp = frame.stamp;
    branches.push_back({std::move(child), result});
  }
  return branches;
}

RememberedSighting sightingOf(const MarkerDetection& detection, const FrameResult& result,
                              const MountedCamera& camera, const Pose& map_from_base) {
  return {result.stamp,
          {*detection.map_entry, detection.corners, detection.center},
          camera.withError(result.imaging_error),
          map_from_base};
}

Branch stayingAt(const PoseEstimate& predicted, const FrameResult& found, const MarkerMap& map,
                 const EstimatorConfig& config, const MountedCamera& camera, Branch branch) {
  const PosePrior prior = PosePrior::about(predicted);
  std::vector<std::size_t> elsewhere = acceptedEntries(found);
  for (const MarkerObservation& observation : acceptedObservations(found)) {
    const bool is_in_place = branch.hypothesis.memory.inPlace(observation.map_entry) != nullptr &&
                             agreesWithPrior(map, config, camera, observation, prior);
    if (!is_in_place) continue;
    elsewhere.erase(std::find(elsewhere.begin(), elsewhere.end(), observation.map_entry));
  }
  if (elsewhere.empty()) elsewhere = acceptedEntries(found);
  const std::vector<std::size_t> missed = std::move(branch.result.missed);
  branch.result = found;
  branch.result.missed = missed;
  branch.result.map_from_base = predicted;
  branch.result.mode = Mode::kDeadReckoning;
  for (MarkerDetection& detection : branch.result.detections) {
    if (!detection.accepted) continue;
    const auto end = elsewhere.end();
    if (std::find(elsewhere.begin(), end, *detection.map_entry) == end) continue;
    detection.accepted = false;
    detection.reason = kElsewhere;
  }
  branch.result.elsewhere = std::move(elsewhere);
  return branch;
}

void carryOn(const PoseEstimate& predicted, bool is_refuted, const MarkerMap& map,
             FrameResult* result) {
  rejectAccepted("contradicts the predicted pose", result);
  if (is_refuted || contradictions(*result, map) > 0) {
    result->remark = "the markers that were read contradict the predicted pose";
    return;
  }
  result->mode = Mode::kDeadReckoning;
  result->map_from_base = predicted;
}

std::string eitherOr(const std::vector<std::size_t>& elsewhere, const MarkerMap& map) {
  std::string names;
  for (const std::size_t entry : elsewhere) {
    names += (names.empty() ? "" : ", ") + std::to_string(map.markers[entry].id);
  }
  return "either markers " + names +
         " hang elsewhere than the map says, or the robot is elsewhere than expected";
}

void withhold(const MarkerMap& map, FrameResult* result) {
  result->is_open = true;
  result->remark = eitherOr(result->elsewhere, map);
  result->mode = Mode::kSearching;
  result->map_from_base.reset();
  rejectAccepted("others contradict it", result);
}

}  // namespace omnitag
