#pragma once

#include <optional>

#include "localization/frame_steps.h"
#include "omnitag/localization/frame_result.h"

namespace omnitag {

/// Whether nothing still unseen could contradict what was seen from a pose: more than half of what
/// should be seen agrees with it sharply, so markers that were moved as one must be fewer.
bool isBeyondDoubt(const FrameResult& seen);

/// The pose that a few readings lead to, even if uncertain or ambiguous by themselves, and what is
/// seen from there as in tracking. Nothing if that is not enough to be sure, if a reading
/// contradicts, if a marker that is found from there contradicts (unless the pose is beyond doubt),
/// or if more than one pose is confirmed. `seen`: the readings and where they were read. Adds the
/// time taken to `timings`.
std::optional<FrameResult> confirm(const Glance& seen, bool (*isEnough)(const FrameResult&),
                                   const TrackingTools& tools, const Frame& frame,
                                   const MountedCamera& camera, Timings* timings);

}  // namespace omnitag
