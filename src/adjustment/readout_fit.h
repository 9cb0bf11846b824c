#pragma once

#include <vector>

#include "moving_frame.h"
#include "omnitag/camera/mounted_camera.h"
#include "omnitag/localization/motion_model.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// What the images tell of their own time: how long after a row the next one is exposed.
struct ReadoutFit {
  /// s per row, and its standard deviation; that of one that is held is not looked at.
  double row_readout_time = 0.0;
  double deviation = 0.0;
  /// What the camera seems to be off by; the velocities' part is 0.
  ImagingError camera_error = ImagingError::Zero();
};

/// Least squares over the corners of all frames: the readout time (unless it is held), the modes of
/// the camera's uncertainty, which all frames share, and in each frame the robot's pose and what
/// odometry's velocity is off by. Nothing ties the frames' poses: the time between stamps and
/// images takes no part.
///
/// A robot on a floor leans and odometry errs as `config` says. Starts from `start` and the frames'
/// poses, and leaves the estimated ones in the frames; corners that are far off count less and less
/// (Cauchy's function), the noise being measured from the residuals.
ReadoutFit fitReadout(const MarkerMap& map, const MountedCamera& camera,
                      const MotionModelConfig& config, const ReadoutFit& start, bool is_held,
                      std::vector<MovingFrame>* frames);

}  // namespace omnitag
