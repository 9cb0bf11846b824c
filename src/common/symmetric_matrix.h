#pragma once

#include <Eigen/Core>

namespace omnitag {

/// At most 16 rows, without heap memory. The functions below are compiled only once: Eigen's
/// fixed-size decompositions take the compiler seconds in each source that uses one.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 16, 16>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 16, 1>;

/// The decomposition of a symmetric matrix: its eigenvalues, the smallest first, and their unit
/// eigenvectors as columns.
struct EigenPairs {
  SmallVector values;
  SmallMatrix vectors;
};

/// Only the lower triangle of the matrix is read.
EigenPairs eigenPairs(const SmallMatrix& symmetric);

/// The inverse of a positive definite matrix.
SmallMatrix inverseOf(const SmallMatrix& definite);

/// `semidefinite`^-1 `right`; NaN or zero in directions that the matrix leaves open.
SmallVector solved(const SmallMatrix& semidefinite, const SmallVector& right);

/// The square of an error in standard deviations, e^T C^-1 e: chi-square distributed if the error
/// is normal with this covariance.
double mahalanobisSquare(const SmallVector& error, const SmallMatrix& covariance);

}  // namespace omnitag
