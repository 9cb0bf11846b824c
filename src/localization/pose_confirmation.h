#pragma once

#include <optional>

#include "frame_steps.h"
#include "omnitag/localization/frame_result.h"

namespace omnitag {

/// The pose that a few readings lead to, however uncertain or ambiguous by themselves, with what is
/// seen from there as in tracking, where that is enough to be sure. Nothing where it is not, where
/// a reading contradicts, or where more than one pose is confirmed. `seen`: the readings and where
/// they were read. Adds to `timings` what it took.
std::optional<FrameResult> confirm(const Glance& seen, bool (*isEnough)(const FrameResult&),
                                   const TrackingTools& tools, const Frame& frame,
                                   const MountedCamera& camera, Timings* timings);

}  // namespace omnitag
