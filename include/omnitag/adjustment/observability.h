#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "omnitag/adjustment/calibration_model.h"

namespace omnitag {

/// What the images tell of some parameters.
struct CameraInformation {
  /// Inverse covariance, in units of the parameters' scales.
  Eigen::MatrixXd matrix;
  /// What the gradient would be if all corners were off by one pixel, a column for each way, and by
  /// how many pixels they are.
  Eigen::MatrixX2d common_error_gradient = {};
  double common_error = 0.0;
};

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
                                   const CameraInformation& information);

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
                            const CameraInformation& information);

}  // namespace omnitag
