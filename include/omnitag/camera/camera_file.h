#pragma once

#include <yaml-cpp/yaml.h>

#include <memory>
#include <string>

#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// Reads a camera file (YAML, the format is described in doc/camera_models.md), or what other tools
/// write, told apart by its content: Kalibr's camchain (PATH#NAME names one of several cameras),
/// OpenCV's calibrations, ROS's camera_info, OCamCalib's calib_results.txt. Throws InputError with
/// one line that names the file, the line and the key where something is missing, unknown or out of
/// its range, or where the values together describe no camera.
std::shared_ptr<const CameraModel> loadCamera(const std::string& path);

/// The same file as a camera file of this package, whoever wrote it: what others write is told in
/// its words. Throws InputError where it cannot be read or is nobody's; its own file is not checked
/// otherwise.
YAML::Node readCameraFile(const std::string& path);

/// The file of what names a camera: PATH of PATH#NAME.
std::string cameraFilePath(const std::string& path);

/// What a sensor_msgs/CameraInfo, field by field, says of the camera of its images, as a camera
/// file. `origin` stands for the file name in errors.
YAML::Node cameraFileOfInfo(const YAML::Node& info, const std::string& origin);

/// The same as loadCamera from text; `origin` stands for the file name in errors.
std::shared_ptr<const CameraModel> parseCamera(const std::string& text, const std::string& origin);

/// The same from a file that is parsed already.
std::shared_ptr<const CameraModel> cameraOf(const YAML::Node& file, const std::string& origin);

}  // namespace omnitag
