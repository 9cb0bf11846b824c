#pragma once

#include <memory>
#include <string>

#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// Reads a camera file (YAML, see doc/camera_models.md), or a file of another tool, recognized by
/// its content: Kalibr's camchain (PATH#NAME selects one of several cameras), OpenCV's
/// calibrations, ROS's camera_info, OCamCalib's calib_results.txt. Throws InputError with one line
/// that names the file, the line and the key if something is missing, unknown or out of its range,
/// or if the values together describe no camera.
std::shared_ptr<const CameraModel> loadCamera(const std::string& path);

/// The same as loadCamera from text; `origin` takes the place of the file name in errors.
std::shared_ptr<const CameraModel> parseCamera(const std::string& text, const std::string& origin);

}  // namespace omnitag
