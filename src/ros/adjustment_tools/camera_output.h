#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

#include "adjustment/camera_calibration.h"

namespace omnitag {

/// The frames that the mounting connects.
struct MountingFrames {
  std::string base;
  std::string camera;
};

/// The final report: each parameter with its deviation, the residuals, the mounting and how to use
/// it (none without `frames`, if it was not estimated), remarks.
std::string calibrationReport(const CalibrationResult& result,
                              const std::optional<MountingFrames>& frames);

/// The camera file, with the report as comments.
std::string calibratedFile(const CalibrationResult& result, const CameraTemplate& guess,
                           const std::optional<MountingFrames>& frames);

/// Writes a file completely or not at all, in place of an existing one. Throws InputError.
void writeAtomically(const std::string& path, const std::string& content);

/// The same with a picture (CV_8UC3), in the format of the path's extension; PNG without one.
void writePicture(const std::string& path, const cv::Mat& picture);

}  // namespace omnitag
