#pragma once

#include <Eigen/Core>

namespace omnitag {

/// A symmetric matrix taken apart: its eigenvalues, the smaller first, and their unit eigenvectors
/// as columns.
struct EigenPairs {
  Eigen::Vector2d values;
  Eigen::Matrix2d vectors;
};

/// Compiled once, as Eigen's template takes seconds in each source that uses it. Only the lower
/// triangle of the matrix is read.
EigenPairs eigenPairs(const Eigen::Matrix2d& symmetric);

}  // namespace omnitag
