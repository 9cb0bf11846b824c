#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "omnitag/adjustment/calibration_model.h"
#include "omnitag/adjustment/camera_adjustment.h"

namespace omnitag {

/// Standard deviations of some parameters and how they depend on each other.
struct ParameterUncertainty {
  /// Indices of the model's parameters, and for each its standard deviation in its own unit.
  std::vector<Eigen::Index> free;
  Eigen::VectorXd deviations;
  Eigen::MatrixXd correlations;
};

/// What the information says about the parameters `free`, in its order, all others being known.
ParameterUncertainty uncertaintyOf(const CalibrationModel& model,
                                   const std::vector<Eigen::Index>& free,
                                   const AdjustmentInformation& information);

/// Which parameters the images tell, and which must be known from elsewhere.
struct Observability {
  std::vector<Eigen::Index> observed;
  /// Those to hold, and the standard deviation that each would have if it were estimated with the
  /// observed ones and those that are held after it.
  std::vector<std::pair<Eigen::Index, double>> held;
};

/// Takes parameters out of `candidates` until images tell all of those that are left as exactly as
/// is tolerable. Where several trade off against each other, the one goes first that matters least
/// or that a user can measure: the mirror's size, coefficients of high order, its shape.
Observability observability(const CalibrationModel& model,
                            const std::vector<Eigen::Index>& candidates,
                            const AdjustmentInformation& information);

}  // namespace omnitag
