#pragma once

#include <cstddef>
#include <vector>

#include "adjustment/moving_frame.h"
#include "adjustment/odometry_at.h"
#include "localization/motion_model.h"

namespace omnitag {

/// The time from the stamps to the exposure of the middle rows.
struct OffsetFit {
  /// s, and its standard deviation; infinity if the data do not determine it.
  double offset = 0.0;
  double deviation = 0.0;
  /// The number of motions from image to image covered by odometry, and how many are needed.
  std::size_t motions = 0;
  static constexpr std::size_t kFewestMotions = 8;
};

/// Least squares over the motions from each frame to the next: odometry, shifted by the offset,
/// must move as the frames' poses do. Only changes of velocity determine the offset: at constant
/// velocity, odometry at another time shows the same motion.
///
/// The errors of odometry, per rad and per metre, are learnt from the residuals, starting from
/// `config`; motions that are far off, as with slipping wheels, count less and less (Cauchy's
/// function). Finds offsets of up to half a second without an initial guess.
OffsetFit fitOffset(const std::vector<MovingFrame>& frames, const OdometryAt& odometry,
                    const MotionModelConfig& config);

}  // namespace omnitag
