#pragma once

#include <functional>
#include <optional>

#include "omnitag/camera/shutter.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/motion_model.h"

namespace omnitag {

/// odom_from_base at a time (s); nothing where odometry does not reach.
using OdometryAt = std::function<std::optional<Pose>(double time)>;

/// How the base moves at a time (s), by the odometry about it and with the deviations that the
/// configuration gives it; nothing where odometry does not reach.
std::optional<BaseMotion> baseMotionAt(const OdometryAt& odometry, double time,
                                       const MotionModelConfig& config);

}  // namespace omnitag
