#include "adjustment/undetermined.h"

#include <array>
#include <cmath>

#include "adjustment/recording.h"
#include "common/rotation.h"

namespace omnitag {

ScaledInverse::ScaledInverse(const Eigen::MatrixXd& information)
    : scales_(information.diagonal().cwiseMax(0.0).cwiseSqrt()) {
  // Relative to an unknown's own information, of which rounding leaves about 1e-12.
  constexpr double kNothing = 1e-11;
  const bool is_told = (scales_.array() > 0.0).all() && scales_.allFinite();
  if (!is_told) scales_ = scales_.cwiseMax(1e-12);
  const Eigen::VectorXd inverse = scales_.cwiseInverse();
  scaled_ = inverse.asDiagonal() * information * inverse.asDiagonal();
  factors_.compute(scaled_);
  is_determined_ =
      is_told && factors_.info() == Eigen::Success && factors_.vectorD().minCoeff() > kNothing;
}

Eigen::MatrixXd ScaledInverse::matrix() const {
  const Eigen::VectorXd inverse = scales_.cwiseInverse();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(scales_.size(), scales_.size());
  return inverse.asDiagonal() * factors_.solve(identity) * inverse.asDiagonal();
}

Eigen::VectorXd ScaledInverse::weakest() const {
  // Inverse iteration, with a tiny number instead of zero.
  constexpr double kAlmostNothing = 1e-13;
  constexpr int kRounds = 4;
  Eigen::MatrixXd regular = scaled_;
  regular.diagonal().array() += kAlmostNothing;
  const Eigen::LDLT<Eigen::MatrixXd> factors(regular);
  Eigen::VectorXd direction = Eigen::VectorXd::LinSpaced(scales_.size(), 1.0, 2.0);
  for (int round = 0; round < kRounds; ++round) direction = factors.solve(direction).normalized();
  return direction.cwiseQuotient(scales_);
}

std::string nameOfDirection(const Bundle& bundle, const std::vector<Eigen::Index>& places,
                            const Eigen::VectorXd& direction) {
  constexpr std::array<const char*, 7> kNames = {
      "where the map is along x", "where the map is along y", "the height of the map",
      "the map's roll",           "the map's pitch",          "the map's heading",
      "the scale of the map"};
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(direction.size(), 7);
  std::size_t farthest = 0;
  double most = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] < 0) continue;
    const Eigen::Vector3d center = bundle.landmarks[i].marker.center();
    motions.block<3, 3>(places[i], 0).setIdentity();
    motions.block<3, 3>(places[i], 3) = -crossMatrix(center);
    motions.block<3, 3>(places[i] + 3, 3).setIdentity();
    motions.block<3, 1>(places[i], 6) = center;
    const double moved = direction.segment<6>(places[i]).norm();
    if (moved <= most) continue;
    most = moved;
    farthest = i;
  }
  const Eigen::VectorXd shares = motions.completeOrthogonalDecomposition().solve(direction);
  constexpr double kMostly = 0.9;
  if ((motions * shares).norm() < kMostly * direction.norm()) {
    return "the place of " + nameOf(bundle.landmarks[farthest].marker);
  }
  Eigen::Index first = 0;
  (shares.cwiseProduct(motions.colwise().norm().transpose())).cwiseAbs().maxCoeff(&first);
  return kNames[static_cast<std::size_t>(first)];
}

}  // namespace omnitag
