#pragma once

#include <string>
#include <vector>

namespace omnitag {

/// A camera file in a format, and what of the camera the format has no place for.
struct WrittenCamera {
  std::string text;
  /// Keys of this package's camera file.
  std::vector<std::string> left_out;
};

/// The formats: "omnitag", "kalibr" (camchain), "opencv" (FileStorage), "camera_info" (as ROS's
/// camera_calibration writes it), "ocam" (OCamCalib's calib_results.txt).
const std::vector<std::string>& cameraFormats();

/// A camera file, whoever wrote it, in a format. Numbers keep all of their digits; "ocam" has a
/// polynomial in place of other models, which is off by less than a fiftieth of a pixel. `output`
/// is where the text will be: a camera file may name another one beside it. Throws InputError where
/// the file is no camera's, and where the format has no such camera.
WrittenCamera writtenCamera(const std::string& path, const std::string& format,
                            const std::string& output);

}  // namespace omnitag
