#include "camera/mirror_profile.h"

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "omnitag/common/error.h"

namespace omnitag {

MirrorProfile MirrorProfile::conic(double radius_of_curvature, double conic_constant,
                                   std::vector<double> coefficients) {
  return MirrorProfile(
      Conic{1.0 / radius_of_curvature, 1.0 + conic_constant, std::move(coefficients)});
}

MirrorProfile MirrorProfile::tabulated(const std::vector<Eigen::Vector2d>& samples) {
  if (samples.size() < 4) {
    throw InputError("expected at least 4 samples [rho, sag], found " +
                     std::to_string(samples.size()));
  }
  double last_rho = -1.0;
  for (const Eigen::Vector2d& sample : samples) {
    const double rho = sample.x();
    if (!(rho >= 0.0 && rho > last_rho && sample.allFinite())) {
      std::ostringstream message;
      message << "expected samples [rho, sag] with rho increasing from >= 0, found [" << sample.x()
              << ", " << sample.y() << "]";
      if (last_rho >= 0.0) message << " after rho " << last_rho;
      throw InputError(message.str());
    }
    last_rho = rho;
  }

  const std::vector<double> second = secondDerivatives(samples);
  Spline spline;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const double step = samples[i + 1].x() - samples[i].x();
    const double secant = (samples[i + 1].y() - samples[i].y()) / step;
    spline.pieces.push_back({samples[i].x(), samples[i].y(),
                             secant - step * (2.0 * second[i] + second[i + 1]) / 6.0,
                             0.5 * second[i], (second[i + 1] - second[i]) / (6.0 * step)});
  }
  // Zero except for rounding; the ray along the axis must return along the axis.
  if (samples.front().x() == 0.0) spline.pieces.front().slope = 0.0;
  spline.end = samples.back().x();
  return MirrorProfile(std::move(spline));
}

std::vector<double> MirrorProfile::secondDerivatives(const std::vector<Eigen::Vector2d>& samples) {
  // Continuity of the slope at the inner samples, and one condition at each end. On the axis
  // symmetry demands a slope of zero; elsewhere the outermost two pieces are one cubic
  // ("not-a-knot"), which, unlike a natural end, does not flatten an edge.
  const auto count = static_cast<Eigen::Index>(samples.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right_side = Eigen::VectorXd::Zero(count);
  const auto growth = [&](Eigen::Index i) -> Eigen::Vector2d {
    const auto index = static_cast<std::size_t>(i);
    return samples[index + 1] - samples[index];
  };
  const auto step = [&](Eigen::Index i) { return growth(i).x(); };
  const auto secant = [&](Eigen::Index i) { return growth(i).y() / growth(i).x(); };
  for (Eigen::Index i = 1; i + 1 < count; ++i) {
    entries.emplace_back(i, i - 1, step(i - 1));
    entries.emplace_back(i, i, 2.0 * (step(i - 1) + step(i)));
    entries.emplace_back(i, i + 1, step(i));
    right_side(i) = 6.0 * (secant(i) - secant(i - 1));
  }
  const auto addNotAKnot = [&](Eigen::Index row, Eigen::Index first) {
    entries.emplace_back(row, first, step(first + 1));
    entries.emplace_back(row, first + 1, -(step(first) + step(first + 1)));
    entries.emplace_back(row, first + 2, step(first));
  };
  if (samples.front().x() == 0.0) {
    entries.emplace_back(0, 0, 2.0 * step(0));
    entries.emplace_back(0, 1, step(0));
    right_side(0) = 6.0 * secant(0);
  } else {
    addNotAKnot(0, 0);
  }
  addNotAKnot(count - 1, count - 3);

  Eigen::SparseMatrix<double> system(count, count);
  system.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(system);
  if (solver.info() != Eigen::Success) {
    throw InputError("expected samples [rho, sag] of a smooth curve, found no spline through them");
  }
  const Eigen::VectorXd solution = solver.solve(right_side);
  return {solution.data(), solution.data() + count};
}

MirrorProfile::Point MirrorProfile::at(double rho) const {
  if (const auto* conic = std::get_if<Conic>(&shape_)) return evaluate(*conic, rho);
  return evaluate(std::get<Spline>(shape_), rho);
}

double MirrorProfile::minRho() const {
  const auto* spline = std::get_if<Spline>(&shape_);
  return spline != nullptr ? spline->pieces.front().start : 0.0;
}

double MirrorProfile::maxRho() const {
  if (const auto* spline = std::get_if<Spline>(&shape_)) return spline->end;
  const auto& conic = std::get<Conic>(shape_);
  if (conic.one_plus_conic_constant <= 0.0) return std::numeric_limits<double>::infinity();
  return 1.0 / (conic.curvature * std::sqrt(conic.one_plus_conic_constant));
}

MirrorProfile::Point MirrorProfile::evaluate(const Conic& conic, double rho) {
  const double c = conic.curvature;
  const double rho2 = rho * rho;
  const double root = std::sqrt(1.0 - conic.one_plus_conic_constant * c * c * rho2);
  const double inverse_root = 1.0 / root;
  Point point{c * rho2 / (1.0 + root), c * rho * inverse_root,
              c * inverse_root * inverse_root * inverse_root};
  double power = rho2;  // rho^(exponent - 2)
  double exponent = 4.0;
  for (const double coefficient : conic.coefficients) {
    point.sag += coefficient * power * rho2;
    point.slope += exponent * coefficient * power * rho;
    point.curvature += exponent * (exponent - 1.0) * coefficient * power;
    power *= rho2;
    exponent += 2.0;
  }
  return point;
}

MirrorProfile::Point MirrorProfile::evaluate(const Spline& spline, double rho) {
  const auto next =
      std::upper_bound(spline.pieces.begin() + 1, spline.pieces.end(), rho,
                       [](double value, const Piece& piece) { return value < piece.start; });
  const Piece& piece = *(next - 1);
  const double x = rho - piece.start;
  return {piece.sag + x * (piece.slope + x * (piece.quadratic + x * piece.cubic)),
          piece.slope + x * (2.0 * piece.quadratic + x * 3.0 * piece.cubic),
          2.0 * piece.quadratic + x * 6.0 * piece.cubic};
}

}  // namespace omnitag
