#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/evidence.h"
#include "localization/hypothesis.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A hypothesis, and a frame's result under it: what is weighed, pruned and merged.
struct Branch {
  Hypothesis hypothesis;
  FrameResult result;
  /// Whether the pose comes from a search, which does not show what else should have been seen.
  bool is_of_search = false;
  double log_probability = 0.0;
};

/// What is known of a frame before its image is processed.
FrameResult emptyResult(const Frame& frame, const LocalizerConfig& config);

/// The possible histories of a robot that is at `pose`, not where `branch` puts it: something
/// carried it there, or it was elsewhere all along. The branch's markers then hang elsewhere,
/// unless they are in their places from there, too. `before`: the branch's hypothesis without the
/// frame.
std::vector<Hypothesis> childrenAt(const Pose& pose, const Frame& frame,
                                   const MountedCamera& camera, const Hypothesis& before,
                                   const Branch& branch, const Evidence& evidence);

/// The branches of such hypotheses, with the frame's pose and what the frame shows from there.
std::vector<Branch> branchesOf(std::vector<Hypothesis> children, const PoseEstimate& pose,
                               FrameResult result, const Frame& frame);

/// The branch of a robot that is where it was expected, although the markers of a frame put it
/// elsewhere. Of these, those stay in their places that were there in earlier images of `branch`
/// and, as far as the prediction tells, still are: others that came into view may have been moved,
/// and pull the frame's pose off. The rest hang elsewhere, and so do all if none else does: then
/// something moved the robot.
Branch stayingAt(const PoseEstimate& predicted, const FrameResult& found, const MarkerMap& map,
                 const EstimatorConfig& config, const MountedCamera& camera, Branch branch);

/// The sighting to remember for a detection of a map entry, from a pose.
RememberedSighting sightingOf(const MarkerDetection& detection, const FrameResult& result,
                              const MountedCamera& camera, const Pose& map_from_base);

/// Sets the result of a frame in which no marker agrees: the prediction, unless the readings
/// contradict it.
void carryOn(const PoseEstimate& predicted, bool is_refuted, const MarkerMap& map,
             FrameResult* result);

/// Says that either these markers hang elsewhere than the map says, or the robot is elsewhere.
std::string eitherOr(const std::vector<std::size_t>& elsewhere, const MarkerMap& map);

/// Leaves a frame without a pose, because its markers that hang elsewhere may just as well be in
/// their places and the robot elsewhere.
void withhold(const MarkerMap& map, FrameResult* result);

/// In words, how far a pose is off the expected one.
std::string howFarOff(const Pose& found, const Pose& expected);

}  // namespace omnitag
