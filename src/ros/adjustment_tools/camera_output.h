#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "omnitag/adjustment/camera_calibration.h"

namespace omnitag {

/// The frames between which the mounting is.
struct MountingFrames {
  std::string base;
  std::string camera;
};

/// What the tool says at its end: each parameter with its deviation, the residuals, the mounting
/// and how to use it, remarks.
std::string calibrationReport(const CalibrationResult& result, const MountingFrames& frames);

/// The camera file, with the report as comments.
std::string calibratedFile(const CalibrationResult& result, const CameraTemplate& guess,
                           const MountingFrames& frames);

/// Writes a file as a whole or not at all, in the place of what was there. Throws InputError.
void writeAtomically(const std::string& path, const std::string& content);
void writePicture(const std::string& path, const cv::Mat& picture);

}  // namespace omnitag
