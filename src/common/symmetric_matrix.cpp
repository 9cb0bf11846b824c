#include "omnitag/common/symmetric_matrix.h"

#include <Eigen/Eigenvalues>

namespace omnitag {

EigenPairs eigenPairs(const Eigen::Matrix2d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace omnitag
