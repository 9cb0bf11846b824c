#include "adjustment/joint_estimate.h"

#include <Eigen/Cholesky>

namespace omnitag {

Eigen::MatrixXd part(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& places) {
  const auto size = static_cast<Eigen::Index>(places.size());
  Eigen::MatrixXd result(size, size);
  for (Eigen::Index row = 0; row < size; ++row) {
    for (Eigen::Index column = 0; column < size; ++column) {
      result(row, column) =
          matrix(places[static_cast<std::size_t>(row)], places[static_cast<std::size_t>(column)]);
    }
  }
  return result;
}

void JointEstimate::append(const Eigen::VectorXd& variances) {
  const Eigen::Index before = mean.size();
  const Eigen::Index count = variances.size();
  mean.conservativeResize(before + count);
  mean.tail(count).setZero();
  covariance.conservativeResize(before + count, before + count);
  covariance.rightCols(count).setZero();
  covariance.bottomRows(count).setZero();
  covariance.diagonal().tail(count) = variances;
}

JointEstimate JointEstimate::part(const std::vector<Eigen::Index>& indices) const {
  Eigen::VectorXd means(static_cast<Eigen::Index>(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i) {
    means(static_cast<Eigen::Index>(i)) = mean(indices[i]);
  }
  return {means, omnitag::part(covariance, indices)};
}

void JointEstimate::update(const std::vector<Eigen::Index>& indices, const JointEstimate& after) {
  const JointEstimate before = part(indices);
  Eigen::MatrixXd rows(before.mean.size(), mean.size());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = covariance.row(indices[i]);
  }
  const Eigen::MatrixXd gain = before.covariance.llt().solve(rows).transpose();
  mean += gain * (after.mean - before.mean);
  covariance -= gain * (before.covariance - after.covariance) * gain.transpose();
  covariance = 0.5 * (covariance + covariance.transpose()).eval();
}

}  // namespace omnitag
