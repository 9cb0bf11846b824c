#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "camera_fit.h"
#include "omnitag/adjustment/camera_calibration.h"
#include "omnitag/adjustment/observability.h"

namespace omnitag {

/// The result of a calibration, with the indices of parameters as in the model.
struct CalibrationOutcome {
  const CameraFit& fit;
  std::vector<Eigen::Index> observed;
  /// Why each parameter was held; empty for one that was not.
  std::vector<std::string> why_held;
};

/// With what the edges of blurred markers err by together.
CameraInformation withCommonError(CameraInformation information);

/// The outcome with what is known of its exactness. Throws InputError where no camera of the
/// model's kind explains the images.
CalibrationResult resultOf(const CalibrationOutcome& outcome, const ResidualSummary& before,
                           const CalibrationConfig& config);

}  // namespace omnitag
