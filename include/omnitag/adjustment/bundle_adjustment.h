#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/adjustment/bundle.h"
#include "omnitag/adjustment/marker_projection.h"

namespace omnitag {

/// After every iteration: its number, and what is left of the cost, from 1 at the start.
using AdjustmentProgress = std::function<void(int, double)>;

/// Moves the camera's parameters, the frames and the landmarks to where all that is known fits
/// best: least squares (Ceres, Levenberg-Marquardt, the poses eliminated by the Schur complement).
/// Observations that the present estimate hides pull at nothing. False where the solver fails;
/// the bundle is then as it was.
bool adjust(Bundle* bundle, const BundleConfig& config, const AdjustmentProgress& progress = {});

/// What the bundle tells at its present state, the poses having been eliminated.
struct BundleInformation {
  /// Inverse covariance of the free camera parameters, in their scales, the markers eliminated,
  /// too; the parameters' own priors are not in it.
  Eigen::MatrixXd camera;
  /// Errors that all corners have in common do not average out. What the gradient would be if all
  /// were off by one pixel, a column for each way: along the image's radius, and out of the marker.
  Eigen::MatrixX2d common_error_gradient;
  /// In the unit of BundleConfig::noise: what the residuals show.
  double noise = 0.0;
  /// For each landmark the covariance of its MarkerIncrement, zero where it is held or not seen,
  /// and the variance of its size, zero where it is not estimated.
  std::vector<MarkerCovariance> landmarks;
  std::vector<double> sizes;
  /// The same within the map: by how much each is off once the map as a whole, which the images
  /// leave where it is, has been laid on the truth. And of that whole (x, y, z, roll, pitch, yaw
  /// about the markers' middle; m and rad) the covariance.
  std::vector<MarkerCovariance> landmarks_within;
  Eigen::Matrix<double, 6, 6> placement = Eigen::Matrix<double, 6, 6>::Zero();
};

/// What a marker errs by in all images alike, as in a shadow that stands still, does not become
/// less by reading it often: by how much its covariance is larger than its number of readings makes
/// it.
double alikeFactor(std::size_t readings);

/// Why there is none: a direction in which everything may move and nothing changes.
struct Undetermined {
  /// In words: "the scale of the map", "the place of marker 7".
  std::string direction;
};

/// `undetermined`, where given, is filled in where there is no information.
std::optional<BundleInformation> information(const Bundle& bundle, const BundleConfig& config,
                                             Undetermined* undetermined = nullptr);

}  // namespace omnitag
