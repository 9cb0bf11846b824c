#pragma once

#include <string>
#include <vector>

#include "omnitag/camera/central_camera.h"
#include "omnitag/camera/ocam_calibration.h"

namespace omnitag {

/// A central camera as OCamCalib's polynomials describe it.
struct OcamFit {
  OcamCalibration calibration;
  /// The toolbox's polynomial for the way from points to pixels: the radius (pixels) over the
  /// elevation above the plane of the lens, from -pi / 2 in the image's middle.
  std::vector<double> inverse;
  /// Pixels, the largest of either polynomial, over the camera's field.
  double error = 0.0;
};

/// The polynomials of the least degree that are off by less than `tolerance` (pixels), or else of
/// the largest degree that is tried. Throws InputError where the camera's image is distorted other
/// than by its radius, which the toolbox does not know.
OcamFit fitOcam(const CentralCamera& camera, double tolerance);

/// The toolbox's calib_results.txt.
std::string ocamText(const OcamFit& fit);

}  // namespace omnitag
