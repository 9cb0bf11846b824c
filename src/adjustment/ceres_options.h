#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

namespace omnitag {

/// For costs and losses that outlive the problem.
inline ceres::Problem::Options notOwning() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

/// Options to solve silently, on one core, until nothing changes.
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
