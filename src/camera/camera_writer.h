#pragma once

#include <string>
#include <vector>

namespace omnitag {

/// A camera file in some format, and what of the camera the format cannot express.
struct WrittenCamera {
  std::string text;
  /// Keys of this package's camera file.
  std::vector<std::string> left_out;
};

/// The formats: "omnitag", "kalibr" (camchain), "opencv" (FileStorage), "camera_info" (as ROS's
/// camera_calibration writes it), "ocam" (OCamCalib's calib_results.txt).
const std::vector<std::string>& cameraFormats();

/// Converts any tool's camera file to one of the formats. Numbers keep all their digits; for models
/// other than its own, "ocam" has a polynomial that is off by less than a fiftieth of a pixel.
/// `output` is where the text will be stored, since a camera file may name another one relative to
/// itself. Throws InputError if the file describes no camera, or if the format has no such camera.
WrittenCamera writtenCamera(const std::string& path, const std::string& format,
                            const std::string& output);

}  // namespace omnitag
