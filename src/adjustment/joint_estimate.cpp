#include "adjustment/joint_estimate.h"

#include <Eigen/Cholesky>

namespace omnitag {

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
  const auto count = static_cast<Eigen::Index>(indices.size());
  JointEstimate some{Eigen::VectorXd(count), Eigen::MatrixXd(count, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index from = indices[static_cast<std::size_t>(i)];
    some.mean(i) = mean(from);
    for (Eigen::Index j = 0; j < count; ++j) {
      some.covariance(i, j) = covariance(from, indices[static_cast<std::size_t>(j)]);
    }
  }
  return some;
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
