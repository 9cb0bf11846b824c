#pragma once

#include <cstddef>
#include <vector>

#include "moving_frame.h"
#include "omnitag/adjustment/odometry_at.h"
#include "omnitag/localization/motion_model.h"

namespace omnitag {

/// How long after their stamps the middle rows are exposed.
struct OffsetFit {
  /// s, and its standard deviation; infinity where nothing tells it.
  double offset = 0.0;
  double deviation = 0.0;
  /// Motions from image to image that odometry has, and how many there must be.
  std::size_t motions = 0;
  static constexpr std::size_t kFewestMotions = 8;
};

/// Least squares over the motions from each frame to the next: odometry, as much later as the
/// frames are exposed, moves as their poses do. Only a change of the velocity shows the offset: at
/// a constant one, odometry a little later moves the same.
///
/// What odometry errs by, per rad and per metre, is learnt from the residuals, starting from
/// `config`; motions that are far off, as of wheels that slip, count less and less (Cauchy's
/// function). Within half a second, no matter where it starts.
OffsetFit fitOffset(const std::vector<MovingFrame>& frames, const OdometryAt& odometry,
                    const MotionModelConfig& config);

}  // namespace omnitag
