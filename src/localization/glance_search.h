#pragma once

#include <optional>

#include "localization/frame_steps.h"
#include "omnitag/localization/frame_result.h"

namespace omnitag {

/// A pose from a glance at the panorama, one sector after another, and what was seen from there:
/// the first marker gives one or two poses from which to look for the others. If fewer than three
/// agree, nothing, and the result only holds the time taken; two are enough if no more should be
/// seen.
std::optional<PoseEstimate> glance(const TrackingTools& tools, const Frame& frame,
                                   const MountedCamera& camera, FrameResult* result);

}  // namespace omnitag
