#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "adjustment/calibration_model.h"

namespace omnitag {

/// The information of the images about some parameters.
struct CameraInformation {
  /// Inverse covariance, in units of the parameters' scales.
  Eigen::MatrixXd matrix;
  /// The gradient if all corners were off by one pixel, a column for each direction, and how many
  /// pixels they are off.
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

/// The uncertainty of the parameters `free`, in the order of the information, given all others.
ParameterUncertainty uncertaintyOf(const CalibrationModel& model,
                                   const std::vector<Eigen::Index>& free,
                                   const CameraInformation& information);

/// Which parameters the images determine, and which must be known from elsewhere.
struct Observability {
  std::vector<Eigen::Index> observed;
  /// The parameters to hold, each with the standard deviation that it would have if it were
  /// estimated together with the observed ones and those held after it.
  std::vector<std::pair<Eigen::Index, double>> held;
};

/// Removes parameters from `candidates` until the images determine all that are left within
/// tolerance. Of several that trade off against each other, removes first the one that matters
/// least or that a user can measure: the mirror's size, coefficients of high order, its shape.
Observability observability(const CalibrationModel& model,
                            const std::vector<Eigen::Index>& candidates,
                            const CameraInformation& information);

}  // namespace omnitag
