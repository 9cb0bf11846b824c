#pragma once

#include <ceres/numeric_diff_cost_function.h>
#include <ceres/sized_cost_function.h>

#include "omnitag/adjustment/map_adjustment.h"
#include "pose_blocks.h"

/// What odometry says of the poses of two images.
namespace omnitag {

/// What a motion on the floor is off from odometry, in its deviations.
class MotionCost : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  explicit MotionCost(const Bundle::Motion& motion) : motion_(motion) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Pose from = poseOf(parameters[0]);
    const Pose to = poseOf(parameters[1]);
    const Pose moved = inverse(from) * to;
    const Eigen::Vector3d weights = motion_.deviations.cwiseInverse();
    Eigen::Map<Eigen::Vector3d> residual(residuals);
    residual = weights.cwiseProduct(difference(moved, motion_.from_from_to).head<3>());
    if (jacobians == nullptr) return true;

    const FloorMotionDerivatives derivatives = floorMotionDerivatives(from, moved);
    using Square = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    if (jacobians[0] != nullptr) {
      Eigen::Map<Square> jacobian(jacobians[0]);
      jacobian = weights.asDiagonal() * derivatives.by_from;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Square> jacobian(jacobians[1]);
      jacobian = weights.asDiagonal() * derivatives.by_to;
    }
    return true;
  }

 private:
  Bundle::Motion motion_;
};

/// The same of any motion: z errs as x and y do, roll and pitch as yaw does.
struct FreeMotion {
  Bundle::Motion motion;

  bool operator()(const double* from_on_floor, const double* from_off_floor,
                  const double* to_on_floor, const double* to_off_floor, double* residuals) const {
    const Pose from = PoseBlocks::poseOf(from_on_floor, from_off_floor);
    const Pose to = PoseBlocks::poseOf(to_on_floor, to_off_floor);
    const Eigen::Vector3d& deviations = motion.deviations;
    PoseVector all;
    all << deviations, deviations[0], deviations[2], deviations[2];
    Eigen::Map<PoseVector> residual(residuals);
    residual = difference(inverse(from) * to, motion.from_from_to).cwiseQuotient(all);
    return true;
  }
};
using FreeMotionCost = ceres::NumericDiffCostFunction<FreeMotion, ceres::CENTRAL, 6, 3, 3, 3, 3>;

}  // namespace omnitag
