#include "common/symmetric_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace omnitag {

EigenPairs eigenPairs(const SmallMatrix& symmetric) {
  const Eigen::SelfAdjointEigenSolver<SmallMatrix> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SmallMatrix inverseOf(const SmallMatrix& definite) {
  return definite.llt().solve(SmallMatrix::Identity(definite.rows(), definite.cols()));
}

SmallVector solved(const SmallMatrix& semidefinite, const SmallVector& right) {
  return semidefinite.ldlt().solve(right);
}

double mahalanobisSquare(const SmallVector& error, const SmallMatrix& covariance) {
  return error.dot(solved(covariance, error));
}

}  // namespace omnitag
