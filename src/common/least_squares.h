#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <array>

#include "omnitag/common/angle.h"
#include "omnitag/common/pose.h"

/// What bundle adjustments with Ceres have in common.
namespace omnitag {

/// x, y and yaw of a robot's pose, as parameters.
using PoseBlock = std::array<double, 3>;

inline PoseBlock blockOf(const Pose& pose) { return {pose.x, pose.y, pose.yaw}; }

/// Of three parameters, whose yaw may have turned more than once.
inline Pose poseOf(const double* block) { return {block[0], block[1], normalizeAngle(block[2])}; }

/// For costs and losses that outlive the problem.
inline ceres::Problem::Options notOwning() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

/// Silent, on one core, until nothing changes.
inline ceres::Solver::Options solverOptions(ceres::LinearSolverType solver, int max_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = solver;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = 1e-9;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace omnitag
