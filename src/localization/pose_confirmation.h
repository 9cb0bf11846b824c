#pragma once

#include <optional>

#include "frame_steps.h"
#include "omnitag/localization/frame_result.h"

namespace omnitag {

/// Whether nothing that is still unseen could speak against what was seen from a pose: more than
/// half of what should be seen agrees with it sharply, and what was moved as one is fewer.
bool isBeyondDoubt(const FrameResult& seen);

/// The pose that a few readings lead to, however uncertain or ambiguous by themselves, with what is
/// seen from there as in tracking, where that is enough to be sure. Nothing where it is not, where
/// a reading contradicts or, unless the pose is beyond doubt, a marker that is found from there, or
/// where more than one pose is confirmed. `seen`: the readings and where they were read. Adds to
/// `timings` what it took.
std::optional<FrameResult> confirm(const Glance& seen, bool (*isEnough)(const FrameResult&),
                                   const TrackingTools& tools, const Frame& frame,
                                   const MountedCamera& camera, Timings* timings);

}  // namespace omnitag
