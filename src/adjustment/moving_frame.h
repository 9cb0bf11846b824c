#pragma once

#include <optional>
#include <vector>

#include "adjustment/calibration_data.h"
#include "camera/mounted_camera.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// An image of a moving robot, and the estimates for it.
struct MovingFrame {
  CalibrationFrame seen;
  /// The robot's pose when the middle row is exposed, and the covariance of its x, y and yaw (m
  /// and rad).
  Pose map_from_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// The motion by odometry, and its error in units of its deviations.
  BaseMotion motion;
  Eigen::Vector3d motion_error = Eigen::Vector3d::Zero();
};

/// The camera as it takes this image, its rows exposed one after the other; the pose is that at the
/// middle row. `camera_error`: only the modes of the camera's own error are used.
inline MountedCamera cameraInFrame(const MountedCamera& camera, const MovingFrame& frame,
                                   const ImagingError& camera_error, double row_readout_time) {
  ShutterConfig shutter;
  shutter.row_readout_time = row_readout_time;
  shutter.image_time_offset = -0.5 * camera.model().imageSize().height * row_readout_time;
  ImagingError error = camera_error;
  error.tail<3>() = frame.motion_error;
  return camera.withMotion(shutter, frame.motion).withError(error);
}

}  // namespace omnitag
