#pragma once

#include <functional>
#include <optional>

#include "camera/shutter.h"
#include "localization/motion_model.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// odom_from_base at a time (s); nothing if odometry does not cover it.
using OdometryAt = std::function<std::optional<Pose>(double time)>;

/// The base's motion at a time (s), from odometry around that time and with the configured
/// deviations; nothing if odometry does not cover it.
std::optional<BaseMotion> baseMotionAt(const OdometryAt& odometry, double time,
                                       const MotionModelConfig& config);

}  // namespace omnitag
