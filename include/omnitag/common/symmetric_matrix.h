#pragma once

#include <Eigen/Core>

namespace omnitag {

/// Of up to 16 rows, held without memory of their own. What is here is compiled once: Eigen's
/// decompositions of a fixed size take seconds in each source that uses one.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 16, 16>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 16, 1>;

/// A symmetric matrix taken apart: its eigenvalues, the smaller first, and their unit eigenvectors
/// as columns.
struct EigenPairs {
  SmallVector values;
  SmallMatrix vectors;
};

/// Only the lower triangle of the matrix is read.
EigenPairs eigenPairs(const SmallMatrix& symmetric);

/// The inverse of a positive definite matrix.
SmallMatrix inverseOf(const SmallMatrix& definite);

/// `semidefinite`^-1 `right`; in directions of which the matrix tells nothing, no number or zero.
SmallVector solved(const SmallMatrix& semidefinite, const SmallVector& right);

/// The square of an error in standard deviations, e^T C^-1 e: chi-square distributed, where the
/// error is normal with this covariance.
double mahalanobisSquare(const SmallVector& error, const SmallMatrix& covariance);

}  // namespace omnitag
