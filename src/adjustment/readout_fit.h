#pragma once

#include <vector>

#include "adjustment/moving_frame.h"
#include "camera/mounted_camera.h"
#include "localization/motion_model.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The readout time, estimated from the images alone.
struct ReadoutFit {
  /// s per row, and its standard deviation, which is not used if the value is held.
  double row_readout_time = 0.0;
  double deviation = 0.0;
  /// Estimated error of the camera; its part for the velocities is 0.
  ImagingError camera_error = ImagingError::Zero();
};

/// Least squares over the corners of all frames. Unknown are the readout time (unless it is held)
/// and the modes of the camera's uncertainty, which all frames share, and for each frame the
/// robot's pose and the error of odometry's velocity. The frames' poses are not tied together, so
/// the time between stamps and images has no effect.
///
/// `config` gives the lean of a robot on a floor and the errors of odometry. Starts from `start`
/// and the frames' poses, and writes the estimated poses to the frames; corners that are far off
/// count less and less (Cauchy's function), with the noise estimated from the residuals.
ReadoutFit fitReadout(const MarkerMap& map, const MountedCamera& camera,
                      const MotionModelConfig& config, const ReadoutFit& start, bool is_held,
                      std::vector<MovingFrame>* frames);

}  // namespace omnitag
