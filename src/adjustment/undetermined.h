#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <string>
#include <vector>

#include "omnitag/adjustment/bundle.h"

/// What a bundle leaves open.
namespace omnitag {

/// The inverse of an information matrix, each unknown in its own unit.
class ScaledInverse {
 public:
  explicit ScaledInverse(const Eigen::MatrixXd& information);

  /// Whether every direction is told, as against the machine's precision.
  bool isDetermined() const { return is_determined_; }
  Eigen::MatrixXd matrix() const;
  /// The direction that is told worst.
  Eigen::VectorXd weakest() const;

 private:
  Eigen::VectorXd scales_;
  Eigen::MatrixXd scaled_;
  Eigen::LDLT<Eigen::MatrixXd> factors_;
  bool is_determined_ = false;
};

/// A direction of the landmarks' increments in words: of the map as a whole, or of the marker that
/// moves most. `places`: where each landmark's increment is in it; negative for none.
std::string nameOfDirection(const Bundle& bundle, const std::vector<Eigen::Index>& places,
                            const Eigen::VectorXd& direction);

}  // namespace omnitag
