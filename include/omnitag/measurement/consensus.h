#pragma once

#include <optional>
#include <vector>

#include "omnitag/common/pose.h"
#include "omnitag/measurement/frame_equations.h"
#include "omnitag/measurement/pose_prior.h"

namespace omnitag {

/// Finds the markers of a frame that agree about its unknowns, where others may hang elsewhere than
/// the map says: of the sets that grow from each marker by the one that agrees best, as long as
/// none disagrees, the largest. Of two that are as large, the one that the prior agrees with.
///
/// `markers`: linearised at `pose` and `error`, with what they err by; nothing for one that is not
/// seen, which agrees. `excess`: how many times larger than that squared errors are.
std::vector<bool> consensusOf(const std::vector<std::optional<FrameEquations>>& markers,
                              const PosePrior& prior, const Pose& pose, const ImagingError& error,
                              double excess);

/// The pose that some of them tell, with the prior.
std::optional<PoseEstimate> poseOf(const std::vector<std::optional<FrameEquations>>& markers,
                                   const std::vector<bool>& which, const PosePrior& prior,
                                   const Pose& pose, const ImagingError& error);

}  // namespace omnitag
