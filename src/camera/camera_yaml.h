#pragma once

#include <yaml-cpp/yaml.h>

#include <memory>
#include <string>

#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// The content as a camera file of this package; files of other tools are translated. Throws
/// InputError if the file cannot be read or its format is unknown; this package's own files are not
/// checked further.
YAML::Node readCameraFile(const std::string& path);

/// The file in the name of a camera: PATH of PATH#NAME.
std::string cameraFilePath(const std::string& path);

/// A sensor_msgs/CameraInfo, given field by field, as a camera file for its images. `origin` takes
/// the place of the file name in errors.
YAML::Node cameraFileOfInfo(const YAML::Node& info, const std::string& origin);

/// The camera of a file that is parsed already. Throws InputError as loadCamera() does.
std::shared_ptr<const CameraModel> cameraOf(const YAML::Node& file, const std::string& origin);

}  // namespace omnitag
