#pragma once

#include <Eigen/Core>

#include "omnitag/camera/camera_uncertainty.h"

namespace omnitag {

/// The imaging error of one image, each entry in standard deviations: the modes of the
/// CameraUncertainty, and the velocities for which BaseMotion has deviations.
constexpr int kImagingUnknowns = kCameraModes + 3;
using ImagingError = Eigen::Matrix<double, kImagingUnknowns, 1>;

}  // namespace omnitag
