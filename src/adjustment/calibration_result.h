#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "omnitag/adjustment/calibration_data.h"
#include "omnitag/adjustment/calibration_model.h"
#include "omnitag/adjustment/camera_adjustment.h"
#include "omnitag/adjustment/camera_calibration.h"

namespace omnitag {

/// What a calibration has come to, with the indices of parameters as the model has them.
struct CalibrationOutcome {
  const CalibrationModel& model;
  const CalibrationData& data;
  const BundleAdjustment& adjustment;
  const CalibrationState& state;
  std::vector<Eigen::Index> observed;
  /// Why each parameter was held; empty for one that was not.
  std::vector<std::string> why_held;
};

/// What the images tell at the outcome, but for what the edges of blurred markers err by together.
AdjustmentInformation informationAt(const BundleAdjustment& adjustment,
                                    const CalibrationState& state, const AdjustmentConfig& config);

/// The outcome with what is known of its exactness. Throws InputError where no camera of the
/// model's kind explains the images.
CalibrationResult resultOf(const CalibrationOutcome& outcome, const ResidualSummary& before,
                           const CalibrationConfig& config);

}  // namespace omnitag
