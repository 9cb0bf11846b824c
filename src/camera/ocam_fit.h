#pragma once

#include <string>
#include <vector>

#include "camera/central_camera.h"
#include "camera/ocam_calibration.h"

namespace omnitag {

/// A central camera as OCamCalib's polynomials describe it.
struct OcamFit {
  OcamCalibration calibration;
  /// The toolbox's polynomial from points to pixels: the radius (pixels) as a function of the
  /// elevation above the plane of the lens, which is -pi / 2 in the image's middle.
  std::vector<double> inverse;
  /// Pixels, the largest error of either polynomial over the camera's field.
  double error = 0.0;
};

/// The polynomials of the lowest degree that are off by less than `tolerance` (pixels), or else the
/// best of all degrees that are tried. Throws InputError if the camera's image plane has a
/// distortion, even a radial one: the toolbox's model has none.
OcamFit fitOcam(const CentralCamera& camera, double tolerance);

/// The toolbox's calib_results.txt.
std::string ocamText(const OcamFit& fit);

}  // namespace omnitag
