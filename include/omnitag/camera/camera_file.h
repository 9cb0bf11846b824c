#pragma once

#include <yaml-cpp/yaml.h>

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

/// The content as a camera file of this package; files of other tools are translated. Throws
/// InputError if the file cannot be read or its format is unknown; this package's own files are not
/// checked further.
YAML::Node readCameraFile(const std::string& path);

/// The file in the name of a camera: PATH of PATH#NAME.
std::string cameraFilePath(const std::string& path);

/// A sensor_msgs/CameraInfo, given field by field, as a camera file for its images. `origin` takes
/// the place of the file name in errors.
YAML::Node cameraFileOfInfo(const YAML::Node& info, const std::string& origin);

/// The same as loadCamera from text; `origin` takes the place of the file name in errors.
std::shared_ptr<const CameraModel> parseCamera(const std::string& text, const std::string& origin);

/// The same from a parsed file.
std::shared_ptr<const CameraModel> cameraOf(const YAML::Node& file, const std::string& origin);

}  // namespace omnitag
