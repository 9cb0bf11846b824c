#pragma once

#include <optional>

#include "frame_steps.h"
#include "omnitag/localization/frame_result.h"

namespace omnitag {

/// A pose from a glance at the panorama itself, one sector after another, and what was seen from
/// there: the first marker tells, in one way or two, where the others are. Nothing, and a
/// result that only knows how long it took, where fewer than three agree then, unless two are all
/// that should be seen.
std::optional<PoseEstimate> glance(const TrackingTools& tools, const Frame& frame,
                                   const MountedCamera& camera, FrameResult* result);

}  // namespace omnitag
