#pragma once

#include <string>
#include <vector>

#include "common/yaml_reader.h"
#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// The content of a calib_results.txt of the OCamCalib toolbox. Its polynomial from points to
/// pixels is left out: it only approximates the inverse of the other one.
struct OcamCalibration {
  /// a0, a1, ...: pixels, per pixel^0, per pixel^1, ...
  std::vector<double> polynomial;
  /// Pixels, the centre of the top-left pixel at (0, 0).
  double center_row = 0.0;
  double center_column = 0.0;
  /// The affine correction [c d; e 1] of (row, column).
  double c = 1.0;
  double d = 0.0;
  double e = 0.0;
  ImageSize image_size;
};

/// Reads such a file. Throws InputError with one line that names the file, the line and what was
/// expected there.
OcamCalibration loadOcamCalibration(const std::string& path);

/// The same from text; `origin` takes the place of the file name in errors.
OcamCalibration parseOcamCalibration(const std::string& text, const std::string& origin);

/// The calibration of a camera file whose model is `ocam`: in the file that `calibration_file`
/// names, or, as `calibration`, in the camera file itself. Throws InputError.
OcamCalibration readOcamCalibration(const YamlReader& camera);

}  // namespace omnitag
