#pragma once

#include <memory>
#include <string>

#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// Reads a camera file (YAML, the format is described in doc/camera_models.md). Throws InputError
/// with one line that names the file, the line and the key where something is missing, unknown or
/// out of its range, or where the values together describe no camera.
std::shared_ptr<const CameraModel> loadCamera(const std::string& path);

/// The same from text; `origin` stands for the file name in errors.
std::shared_ptr<const CameraModel> parseCamera(const std::string& text, const std::string& origin);

}  // namespace omnitag
