#pragma once

#include <string>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/evidence.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/hypothesis.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A hypothesis, and what a frame gives for it.
struct Account {
  Hypothesis hypothesis;
  FrameResult result;
  /// Whether the pose is that of a search, which does not tell what else should have been seen.
  bool is_of_search = false;
  double log_probability = 0.0;
};

/// What is known of a frame before it is looked at.
FrameResult emptyResult(const Frame& frame, const LocalizerConfig& config);

/// What a robot may have gone through that is not where `account` puts it but at `pose`: that
/// something carried it there, and that it was elsewhere all along. The account's markers then hang
/// elsewhere. `before`: the account's hypothesis without the frame.
std::vector<Hypothesis> childrenAt(const Pose& pose, const Frame& frame,
                                   const MountedCamera& camera, const Hypothesis& before,
                                   const Account& account, const Evidence& evidence);

/// The same with the frame's pose, and what it shows from there.
std::vector<Account> accountsOf(std::vector<Hypothesis> children, const PoseEstimate& pose,
                                FrameResult result, const Frame& frame);

/// The account of a robot that is where it was expected, although its markers put it elsewhere.
Account stayingAt(const PoseEstimate& predicted, const FrameResult& found, Account account);

/// A detection of the map as it is remembered from a pose.
RememberedSighting sightingOf(const MarkerDetection& detection, const FrameResult& result,
                              const MountedCamera& camera, const Pose& map_from_base);

/// Without a marker that agrees: the prediction, unless what was read contradicts it.
void carryOn(const PoseEstimate& predicted, bool is_refuted, const MarkerMap& map,
             FrameResult* result);

/// In words, that these markers hang elsewhere than the map says, or the robot is.
std::string eitherOr(const std::vector<std::size_t>& elsewhere, const MarkerMap& map);

/// Leaves a frame without a pose, since its markers that hang elsewhere may as well be in their
/// places and the robot elsewhere.
void withhold(const MarkerMap& map, FrameResult* result);

/// In words, how far a pose is off the expected one.
std::string howFarOff(const Pose& found, const Pose& expected);

}  // namespace omnitag
