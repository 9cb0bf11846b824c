#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "adjustment/camera_calibration.h"
#include "adjustment/camera_fit.h"
#include "adjustment/observability.h"

namespace omnitag {

/// The result of a calibration, with the indices of parameters as in the model.
struct CalibrationOutcome {
  const CameraFit& fit;
  std::vector<Eigen::Index> observed;
  /// Why each parameter was held; empty if it was not.
  std::vector<std::string> why_held;
};

/// Adds the error that the edges of blurred markers have in common.
CameraInformation withCommonError(CameraInformation information);

/// The result with its uncertainty. Throws InputError if no camera of the model's kind explains
/// the images.
CalibrationResult resultOf(const CalibrationOutcome& outcome, const ResidualSummary& before,
                           const CalibrationConfig& config);

}  // namespace omnitag
