#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "adjustment/bundle.h"
#include "adjustment/marker_projection.h"

namespace omnitag {

/// Called after every iteration with its number and the remaining share of the initial cost.
using AdjustmentProgress = std::function<void(int, double)>;

/// Changes the camera's parameters, the frames and the landmarks until everything known fits best:
/// least squares (Ceres, Levenberg-Marquardt, the poses eliminated by the Schur complement).
/// Observations hidden by the present estimate have no effect. False if the solver fails; the
/// bundle is then unchanged.
bool adjust(Bundle* bundle, const BundleConfig& config, const AdjustmentProgress& progress = {});

/// The information of the bundle at its present state, with the poses eliminated.
struct BundleInformation {
  /// Inverse covariance of the free camera parameters, in their scales, with the landmarks
  /// eliminated, too; without the parameters' own priors.
  Eigen::MatrixXd camera;
  /// Errors that all corners have in common do not average out: the gradient if all corners were
  /// off by one pixel, a column for each direction (along the image's radius, and out of the
  /// marker).
  Eigen::MatrixX2d common_error_gradient;
  /// Noise estimated from the residuals, in the unit of BundleConfig::noise.
  double noise = 0.0;
  /// For each landmark, the covariance of its MarkerIncrement, zero if it is held or not seen, and
  /// the variance of its size, zero if it is not estimated.
  std::vector<MarkerCovariance> landmarks;
  std::vector<double> sizes;
  /// The same within the map: the covariance of each landmark's error once the map as a whole,
  /// whose placement the images leave open, is aligned with the true one; and the covariance of
  /// that placement (x, y, z, roll, pitch, yaw about the markers' middle; m and rad).
  std::vector<MarkerCovariance> landmarks_within;
  Eigen::Matrix<double, 6, 6> placement = Eigen::Matrix<double, 6, 6>::Zero();
};

/// The factor by which a marker's covariance exceeds what its number of readings suggests: errors
/// that are the same in all images, as in a shadow that stands still, do not average out.
double alikeFactor(std::size_t readings);

/// Why there is no information: a direction in which everything can move without effect.
struct Undetermined {
  /// In words: "the scale of the map", "the place of marker 7".
  std::string direction;
};

/// `undetermined`, if given, is filled in if there is no information.
std::optional<BundleInformation> information(const Bundle& bundle, const BundleConfig& config,
                                             Undetermined* undetermined = nullptr);

}  // namespace omnitag
