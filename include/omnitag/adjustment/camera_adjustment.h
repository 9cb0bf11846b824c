#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "omnitag/adjustment/calibration_data.h"
#include "omnitag/adjustment/calibration_model.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Everything that an adjustment may change.
struct CalibrationState {
  /// As CalibrationModel::parameters().
  Eigen::VectorXd values;
  /// The robot in the map, one for each frame.
  std::vector<Pose> poses;
};

/// What an adjustment is to change, and how.
struct AdjustmentConfig {
  /// Indices of the model's parameters; the others keep their values.
  std::vector<Eigen::Index> free;
  bool adjusts_poses = true;
  /// Pixels: a corner that is farther off than this counts less and less (Cauchy's function).
  double robust_width = 0.25;
  int max_iterations = 200;
};

/// One corner of one marker in one frame.
struct CornerResidual {
  std::size_t frame = 0;
  std::size_t map_entry = 0;
  /// Where it was measured, in pixels.
  Eigen::Vector2d pixel;
  /// Where it should be, less where it was measured, in pixels; nothing where it should not be
  /// seen.
  std::optional<Eigen::Vector2d> residual;
};

/// What the corners tell about some of the parameters once the poses have been adjusted to them.
struct AdjustmentInformation {
  /// Inverse covariance (the poses being eliminated) for a noise of one pixel along each axis, in
  /// units of the parameters' scales.
  Eigen::MatrixXd matrix;
  /// Pixels, along each axis: the noise that the residuals show.
  double noise = 0.0;
  /// Errors that all corners have in common do not average out. What the gradient would be if all
  /// were off by one pixel, a column for each way: along the image's radius, and out of the marker.
  Eigen::MatrixX2d common_error_gradient;
  /// Pixels, of such errors.
  double common_error = 0.0;
};

/// The bundle adjustment of a recording: the camera, its mounting and the robot's pose in every
/// frame, so that all corners image where they were measured. The guess takes part with a little
/// weight, which decides where the images do not.
///
/// Derivatives by the shared parameters are central differences between cameras that are made once
/// for all corners; those by the poses are analytic.
class BundleAdjustment {
 public:
  /// Keeps references to all three.
  BundleAdjustment(const MarkerMap& map, const std::vector<CalibrationFrame>& frames,
                   const CalibrationModel& model);

  /// After every iteration: its number and what is left of the cost, from 1 at the start.
  using Progress = std::function<void(int, double)>;

  /// The nearest minimum; `start` where that makes no camera.
  CalibrationState minimize(const CalibrationState& start, const AdjustmentConfig& config,
                            const Progress& progress = {}) const;

  /// Of all corners, frame by frame.
  std::vector<CornerResidual> residuals(const CalibrationState& state) const;

  /// `config` says which parameters, and how corners are weighed. Throws InputError where the
  /// state makes no camera.
  AdjustmentInformation information(const CalibrationState& state,
                                    const AdjustmentConfig& config) const;

 private:
  /// How far these parameters are from the guess, in their scales.
  Eigen::VectorXd offsetsOf(const Eigen::VectorXd& values,
                            const std::vector<Eigen::Index>& indices) const;

  const MarkerMap& map_;
  const std::vector<CalibrationFrame>& frames_;
  const CalibrationModel& model_;
};

}  // namespace omnitag
