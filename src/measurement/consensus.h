#pragma once

#include <optional>
#include <vector>

#include "measurement/frame_equations.h"
#include "measurement/pose_prior.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// Finds the markers of a frame that agree about its unknowns when others may hang elsewhere than
/// the map says. A set grows from each marker by the marker that agrees best, as long as it does
/// agree. The largest set wins; of equally large ones, the one that agrees best in itself and with
/// the prior.
///
/// `markers`: linearised at `pose` and `error`, with the covariance of their errors; nothing for a
/// marker that is not seen, which counts as agreeing. `excess`: the factor by which squared errors
/// exceed what is expected.
std::vector<bool> consensusOf(const std::vector<std::optional<FrameEquations>>& markers,
                              const PosePrior& prior, const Pose& pose, const ImagingError& error,
                              double excess);

/// The pose from some of the markers and the prior.
std::optional<PoseEstimate> poseOf(const std::vector<std::optional<FrameEquations>>& markers,
                                   const std::vector<bool>& which, const PosePrior& prior,
                                   const Pose& pose, const ImagingError& error);

}  // namespace omnitag
