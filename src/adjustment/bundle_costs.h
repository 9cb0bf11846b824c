#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "adjustment/bundle.h"
#include "adjustment/perturbed_cameras.h"

/// The terms of a bundle's sum of squares over its parameter blocks. A frame's block is x, y, yaw,
/// z, roll and pitch of its pose; a landmark's are its MarkerIncrement from a reference place, and
/// its size; the camera's is the offsets of its free parameters, in their scales.
namespace omnitag {

using SixBlock = std::array<double, 6>;

SixBlock blockOf(const Pose& pose);
/// The yaw may exceed a full turn.
Pose poseOfBlock(const double* block);
/// Derivative of a pose, as a PoseVector, by its block.
PoseMatrix poseByBlock(const Pose& pose);

Marker markerAt(const Marker& about, const double* increment, double size);

/// The square up to what chance explains (99 of 100), Cauchy's function beyond.
class ExpectedLoss final : public ceres::LossFunction {
 public:
  /// `expected`: this quantile of chi-square with the residual's degrees of freedom: 20.1 for 8,
  /// 16.8 for 6, 6.6 for 1.
  explicit ExpectedLoss(double expected) : expected_(expected) {}
  void Evaluate(double square, double* out) const override;

 private:
  double expected_;
};
constexpr double kExpectedOfMarker = 20.1;
constexpr double kExpectedOfPlace = 16.8;
constexpr double kExpectedOfNumber = 6.6;

/// Whitened errors of a marker's corners in an image. Blocks: frame, landmark, size and, if there
/// are any, the camera's free parameters.
class MarkerCost final : public ceres::CostFunction {
 public:
  /// Keeps the references. `about`: the marker that the landmark's increment is relative to.
  MarkerCost(PerturbedCameras* cameras, const Eigen::Isometry3d& base_from_camera,
             const Marker& about, const Bundle::Observation& observation, double noise);
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  PerturbedCameras* cameras_;
  Eigen::Isometry3d base_from_camera_;
  Marker about_;
  const Bundle::Observation& observation_;
  double noise_;
};

/// Prior of some numbers of a block: for each, the known value and its standard deviation.
class KnownNumbersCost final : public ceres::CostFunction {
 public:
  struct Known {
    int place = 0;
    double value = 0.0;
    double deviation = 1.0;
  };
  KnownNumbersCost(int block_size, std::vector<Known> known);
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  int size_;
  std::vector<Known> known_;
};

/// Error of the motion between two frames relative to odometry, in odometry's deviations: in x, y
/// and yaw, or in all six numbers if the robot is free. Blocks: both frames.
class MotionCost final : public ceres::CostFunction {
 public:
  MotionCost(const Bundle::Motion& motion, bool is_free);
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::VectorXd residualOf(const Pose& from, const Pose& to) const;

  Bundle::Motion motion_;
  bool is_free_;
};

/// Error of a constraint, in its deviations. Blocks: the landmarks that it names.
class ConstraintCost final : public ceres::CostFunction {
 public:
  /// `about`: the constraint's markers, which their increments are relative to.
  ConstraintCost(const PlaceConstraint& constraint, std::vector<Marker> about);
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::VectorXd residualAt(const std::vector<MarkerIncrement>& increments) const;

  PlaceConstraint constraint_;
  std::vector<Marker> about_;
  Eigen::Vector3d up_;
};

}  // namespace omnitag
