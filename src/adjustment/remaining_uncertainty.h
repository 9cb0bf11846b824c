#pragma once

#include "omnitag/adjustment/calibration_model.h"
#include "omnitag/adjustment/observability.h"
#include "omnitag/camera/camera_uncertainty.h"

namespace omnitag {

/// What a calibration leaves of the camera and its mounting, as smooth modes over the image.
/// `left`: of the model's parameters at `values`. `common_error`: pixels by which all corners may
/// err alike, the least that is left of each mode.
CameraUncertainty remainingUncertainty(const CalibrationModel& model, const Eigen::VectorXd& values,
                                       const ParameterUncertainty& left, double common_error);

}  // namespace omnitag
