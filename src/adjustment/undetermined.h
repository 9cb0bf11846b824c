#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <string>
#include <vector>

#include "adjustment/bundle.h"

/// Directions that a bundle leaves undetermined.
namespace omnitag {

/// The inverse of an information matrix whose unknowns have different units.
class ScaledInverse {
 public:
  explicit ScaledInverse(const Eigen::MatrixXd& information);

  /// Whether every direction is determined, relative to machine precision.
  bool isDetermined() const { return is_determined_; }
  Eigen::MatrixXd matrix() const;
  /// The least determined direction.
  Eigen::VectorXd weakest() const;

 private:
  Eigen::VectorXd scales_;
  Eigen::MatrixXd scaled_;
  Eigen::LDLT<Eigen::MatrixXd> factors_;
  bool is_determined_ = false;
};

/// A direction of the landmarks' increments in words: that of the map as a whole, or of the marker
/// that moves most. `places`: index of each landmark's increment in the direction; negative for
/// none.
std::string nameOfDirection(const Bundle& bundle, const std::vector<Eigen::Index>& places,
                            const Eigen::VectorXd& direction);

}  // namespace omnitag
