#include "adjustment/timed_calibration.h"

#include <algorithm>

#include "omnitag/camera/camera_file.h"

namespace omnitag {
namespace {

/// The calibrated camera with the uncertainty that unknown row times may cause.
MountedCamera uncertainCamera(const CameraTemplate& guess, const CalibrationResult& result) {
  constexpr double kShare = 0.004;  // of the image's height, in each mode
  const double deviation = kShare * guess.camera(result.camera_values)->imageSize().height;
  const CameraUncertainty uncertainty{deviation, deviation, deviation, deviation};
  return {
      parseCamera(guess.text(result.camera_values, result.rim_radius, uncertainty), guess.origin()),
      result.base_from_camera};
}

}  // namespace

TimedCalibration calibrateCameraAndTime(const CameraTemplate& guess, const MarkerMap& map,
                                        const std::vector<FrameReadings>& frames,
                                        const CalibrationConfig& config, const OdometryAt& odometry,
                                        const MotionModelConfig& motion,
                                        const CalibrationProgress& progress) {
  // The modes absorb the effect of the times on the camera, so the second round changes little.
  constexpr int kRounds = 2;
  CalibrationConfig without_times = config;
  without_times.max_residual = std::max(config.max_residual, kMaxRollingResidual);
  TimedCalibration calibration;
  calibration.camera = calibrateCamera(guess, map, frames, without_times, progress);
  for (int round = 0; round < kRounds; ++round) {
    if (progress) progress("times of the rows", round);
    calibration.time =
        calibrateTime(map, uncertainCamera(guess, calibration.camera), frames, odometry, motion);
    calibration.camera =
        calibrateCamera(guess, map, calibration.time.at_middle_row, config, progress);
  }
  return calibration;
}

}  // namespace omnitag
