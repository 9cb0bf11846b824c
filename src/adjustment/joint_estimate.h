#pragma once

#include <Eigen/Core>
#include <vector>

namespace omnitag {

/// These rows and columns of a matrix.
Eigen::MatrixXd part(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& places);

/// A normal distribution of many numbers.
struct JointEstimate {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;

  /// Appends numbers of mean zero that are independent of all others.
  void append(const Eigen::VectorXd& variances);

  /// The distribution of some of the numbers.
  JointEstimate part(const std::vector<Eigen::Index>& indices) const;

  /// Learns that a part is not distributed as before, but as `after`: all other numbers follow by
  /// their correlations with it.
  void update(const std::vector<Eigen::Index>& indices, const JointEstimate& after);
};

}  // namespace omnitag
