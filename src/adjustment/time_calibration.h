#pragma once

#include <string>
#include <vector>

#include "adjustment/odometry_at.h"
#include "camera/mounted_camera.h"
#include "localization/frame_readings.h"
#include "localization/motion_model.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A number of ShutterConfig that was estimated.
struct EstimatedTime {
  /// s, or s per row. If it was held, the value is 0, and the deviation is infinite or what it
  /// would be if estimated.
  double value = 0.0;
  double deviation = 0.0;
  /// Why it was held at 0; empty if it was estimated.
  std::string held;
  /// Whether the drive determines it, even if the value is 0.
  bool is_observed = false;
};

/// When a camera's images were taken, relative to their stamps.
struct TimeCalibration {
  EstimatedTime image_time_offset;
  EstimatedTime row_readout_time;
  /// Time from an image's stamp to the middle of the exposure of its middle row, in s.
  double middle_row_offset = 0.0;
  /// Number of motions from image to image covered by odometry.
  std::size_t motions = 0;
  /// The readings, their corners moved to where they would be if all rows had been exposed at the
  /// middle row's time; only of markers that occur once in the map, in frames with a known pose.
  std::vector<FrameReadings> at_middle_row;
};

/// Estimates when the rows of a recording's images were exposed. The images alone determine the
/// poses at the middle rows' times and, given the robot's velocities by odometry, the readout time.
/// Comparing the motion from image to image by odometry and by the poses determines the offset. The
/// modes of the camera's uncertainty are estimated, too: a camera that was calibrated as if all
/// rows were exposed at once is off by more than its uncertainty.
///
/// A time that the drive does not determine to 5 ms (the readout time: of the whole image) is held
/// at 0, as is a readout time that agrees with a global shutter. Throws InputError as
/// selectObservations() does, and if no pose explains the readings.
TimeCalibration calibrateTime(const MarkerMap& map, const MountedCamera& camera,
                              const std::vector<FrameReadings>& frames, const OdometryAt& odometry,
                              const MotionModelConfig& config);

/// The camera as it took the image with this stamp (s), given a time calibration. It applies to the
/// pose at the middle row's time.
MountedCamera cameraAt(const MountedCamera& camera, const TimeCalibration& time,
                       const OdometryAt& odometry, const MotionModelConfig& config, double stamp);

}  // namespace omnitag
