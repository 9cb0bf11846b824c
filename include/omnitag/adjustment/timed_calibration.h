#pragma once

#include <vector>

#include "omnitag/adjustment/camera_calibration.h"
#include "omnitag/adjustment/camera_template.h"
#include "omnitag/adjustment/time_calibration.h"

namespace omnitag {

/// A camera and when its rows are exposed.
struct TimedCalibration {
  CalibrationResult camera;
  TimeCalibration time;
};

/// calibrateCamera() with a robot that moves while images are taken: the camera and the rows' times
/// by turns, until each agrees with the other. The residuals are those of corners that have been
/// moved to where the middle row's time would have shown them. Throws as both do.
TimedCalibration calibrateCameraAndTime(const CameraTemplate& guess, const MarkerMap& map,
                                        const std::vector<FrameReadings>& frames,
                                        const CalibrationConfig& config, const OdometryAt& odometry,
                                        const MotionModelConfig& motion,
                                        const CalibrationProgress& progress = {});

/// Pixels: a residual (CalibrationConfig::max_residual) that rows exposed one after the other may
/// leave where nothing is known of their times yet.
constexpr double kMaxRollingResidual = 10.0;

}  // namespace omnitag
