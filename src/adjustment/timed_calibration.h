#pragma once

#include <vector>

#include "adjustment/camera_calibration.h"
#include "adjustment/camera_template.h"
#include "adjustment/time_calibration.h"

namespace omnitag {

/// A camera and the times at which its rows are exposed.
struct TimedCalibration {
  CalibrationResult camera;
  TimeCalibration time;
};

/// calibrateCamera() for a robot that moves while images are taken: the camera and the rows' times
/// are calibrated in turn until they agree. The residuals are of corners moved to where they would
/// be at the middle row's time. Throws as both do.
TimedCalibration calibrateCameraAndTime(const CameraTemplate& guess, const MarkerMap& map,
                                        const std::vector<FrameReadings>& frames,
                                        const CalibrationConfig& config, const OdometryAt& odometry,
                                        const MotionModelConfig& motion,
                                        const CalibrationProgress& progress = {});

/// Pixels: the residual (CalibrationConfig::max_residual) allowed while the times of successively
/// exposed rows are not known yet.
constexpr double kMaxRollingResidual = 10.0;

}  // namespace omnitag
