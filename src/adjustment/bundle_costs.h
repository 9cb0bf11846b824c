#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "omnitag/adjustment/bundle.h"
#include "perturbed_cameras.h"

/// The terms of a bundle's sum of squares, over its blocks of parameters: of a frame x, y, yaw, z,
/// roll and pitch of its pose; of a landmark the MarkerIncrement from a place, and the size; of the
/// camera the offsets of its free parameters, in their scales.
namespace omnitag {

using SixBlock = std::array<double, 6>;

SixBlock blockOf(const Pose& pose);
/// The yaw may have turned more than once.
Pose poseOfBlock(const double* block);
/// How a pose changes, as a PoseVector, with its block.
PoseMatrix poseByBlock(const Pose& pose);

Marker markerAt(const Marker& about, const double* increment, double size);

/// Squares up to what chance (99 of 100) leaves, and from there on Cauchy's function.
class ExpectedLoss final : public ceres::LossFunction {
 public:
  /// Of chi-square with the residual's degrees of freedom: 20.1 of 8, 16.8 of 6, 6.6 of 1.
  explicit ExpectedLoss(double expected) : expected_(expected) {}
  void Evaluate(double square, double* out) const override;

 private:
  double expected_;
};
constexpr double kExpectedOfMarker = 20.1;
constexpr double kExpectedOfPlace = 16.8;
constexpr double kExpectedOfNumber = 6.6;

/// What a marker's corners are off in an image, whitened. Blocks: frame, landmark, size and, where
/// any of the camera's parameters are free, these.
class MarkerCost final : public ceres::CostFunction {
 public:
  /// Keeps references, and `about`, from which the landmark's increment counts.
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

/// Some numbers of a block, each with a value that it is known to have, and its standard deviation.
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

/// What the motion between two frames is off from odometry, in its deviations: along x, y and yaw,
/// and along all six where the robot is free. Blocks: both frames.
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

/// What a constraint is off, in its deviation. Blocks: the landmarks that it names.
class ConstraintCost final : public ceres::CostFunction {
 public:
  /// `about`: the constraint's markers, from which their increments count.
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
