#pragma once

#include "adjustment/calibration_model.h"
#include "adjustment/observability.h"
#include "omnitag/camera/camera_uncertainty.h"

namespace omnitag {

/// The remaining uncertainty of the camera and its mounting after a calibration, as smooth modes
/// over the image. `left`: the uncertainty of the model's parameters at `values`. `common_error`:
/// the error that all corners may have in common, in pixels; a lower bound of each mode.
CameraUncertainty remainingUncertainty(const CalibrationModel& model, const Eigen::VectorXd& values,
                                       const ParameterUncertainty& left, double common_error);

}  // namespace omnitag
