#pragma once

#include <string>
#include <vector>

#include "omnitag/adjustment/odometry_at.h"
#include "omnitag/camera/mounted_camera.h"
#include "omnitag/localization/frame_readings.h"
#include "omnitag/localization/motion_model.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A number of ShutterConfig that was estimated.
struct EstimatedTime {
  /// s, or s per row; 0 where it was held, but for a deviation that is infinite or says what it
  /// would be.
  double value = 0.0;
  double deviation = 0.0;
  /// Why it was held at 0; empty where it was estimated.
  std::string held;
  /// Whether the drive tells it, be it that it is 0.
  bool is_observed = false;
};

/// When a camera's images were taken, and how the robot moved meanwhile.
struct TimeCalibration {
  EstimatedTime image_time_offset;
  EstimatedTime row_readout_time;
  /// s, from an image's stamp to the middle of the exposure of its middle row.
  double middle_row_offset = 0.0;
  /// Motions from image to image that odometry has.
  std::size_t motions = 0;
  /// The readings, corners being where they would be had all rows been exposed at the middle row's
  /// time; those of markers that the map has once, in frames whose pose is known.
  std::vector<FrameReadings> at_middle_row;
};

/// Estimates when the rows of a recording's images were exposed. The images alone tell the poses at
/// the middle rows' times and, by how odometry has the robot turn and drive, the readout time; how
/// odometry's motions from image to image compare with those of the poses tells the offset. The
/// modes of the camera's uncertainty are estimated with them: a camera that was calibrated as if
/// all rows were exposed at once is off by more than it says.
///
/// What the drive does not tell to 5 ms (of the whole image, as to the readout time) is held at 0,
/// and so is a readout time that agrees with a global shutter. Throws InputError as
/// selectObservations() does, and where no pose explains what was read.
TimeCalibration calibrateTime(const MarkerMap& map, const MountedCamera& camera,
                              const std::vector<FrameReadings>& frames, const OdometryAt& odometry,
                              const MotionModelConfig& config);

/// The camera as it took the image of this stamp (s), by a calibration. The pose that goes with it
/// is that at the middle row's time.
MountedCamera cameraAt(const MountedCamera& camera, const TimeCalibration& time,
                       const OdometryAt& odometry, const MotionModelConfig& config, double stamp);

}  // namespace omnitag
