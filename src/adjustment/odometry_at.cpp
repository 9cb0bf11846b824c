#include "adjustment/odometry_at.h"

#include <initializer_list>

namespace omnitag {

std::optional<BaseMotion> baseMotionAt(const OdometryAt& odometry, double time,
                                       const MotionModelConfig& config) {
  // Odometry comes at 20 to 100 Hz: over a shorter time, noise would dominate.
  constexpr double kDuration = 0.04;  // s
  // At the beginning and the end of odometry, the nearest motion is used.
  for (const double begin : {time - 0.5 * kDuration, time - kDuration, time}) {
    const std::optional<Pose> before = odometry(begin);
    const std::optional<Pose> after = odometry(begin + kDuration);
    if (!before || !after) continue;
    const Eigen::Isometry3d motion = before->toIsometry().inverse() * after->toIsometry();
    return MotionModel(config).motionBy(velocityOf(motion, kDuration));
  }
  return std::nullopt;
}

}  // namespace omnitag
