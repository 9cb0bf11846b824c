#include "omnitag/camera/mirror_profile.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
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
  const auto count = static_cast<Eigen::Index>(samples.size());
  if (count < 4) {
    throw InputError("expected at least 4 samples [rho, sag], found " + std::to_string(count));
  }
  Spline spline;
  for (const Eigen::Vector2d& sample : samples) {
    if (sample.x() < 0.0 || (!spline.rho.empty() && sample.x() <= spline.rho.back())) {
      throw InputError("expected rho to increase from >= 0, found " + std::to_string(sample.x()) +
                       " in sample " + std::to_string(spline.rho.size()));
    }
    spline.rho.push_back(sample.x());
    spline.sag.push_back(sample.y());
  }

  // The cubic spline's second derivatives m: continuity of the slope at the inner samples, and one
  // condition at each end. On the axis symmetry demands a slope of zero; elsewhere the outermost
  // two pieces are one cubic ("not-a-knot"), which, unlike a natural end, does not flatten an edge.
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd right_side = Eigen::VectorXd::Zero(count);
  const auto step = [&](Eigen::Index i) { return samples[i + 1].x() - samples[i].x(); };
  const auto secant = [&](Eigen::Index i) {
    return (samples[i + 1].y() - samples[i].y()) / step(i);
  };
  for (Eigen::Index i = 1; i + 1 < count; ++i) {
    system(i, i - 1) = step(i - 1);
    system(i, i) = 2.0 * (step(i - 1) + step(i));
    system(i, i + 1) = step(i);
    right_side(i) = 6.0 * (secant(i) - secant(i - 1));
  }
  const auto notAKnot = [&](Eigen::Index row, Eigen::Index first) {
    system(row, first) = step(first + 1);
    system(row, first + 1) = -(step(first) + step(first + 1));
    system(row, first + 2) = step(first);
  };
  if (samples.front().x() == 0.0) {
    system(0, 0) = 2.0 * step(0);
    system(0, 1) = step(0);
    right_side(0) = 6.0 * secant(0);
  } else {
    notAKnot(0, 0);
  }
  notAKnot(count - 1, count - 3);

  const Eigen::VectorXd solution = system.partialPivLu().solve(right_side);
  spline.second_derivative.assign(solution.data(), solution.data() + count);
  return MirrorProfile(std::move(spline));
}

MirrorProfile::Point MirrorProfile::at(double rho) const {
  return std::visit([rho](const auto& shape) { return evaluate(shape, rho); }, shape_);
}

double MirrorProfile::minRho() const {
  const auto* spline = std::get_if<Spline>(&shape_);
  return spline != nullptr ? spline->rho.front() : 0.0;
}

double MirrorProfile::maxRho() const {
  if (const auto* spline = std::get_if<Spline>(&shape_)) return spline->rho.back();
  const auto& conic = std::get<Conic>(shape_);
  if (conic.one_plus_conic_constant <= 0.0) return std::numeric_limits<double>::infinity();
  return 1.0 / (conic.curvature * std::sqrt(conic.one_plus_conic_constant));
}

MirrorProfile::Point MirrorProfile::evaluate(const Conic& conic, double rho) {
  const double c = conic.curvature;
  const double root = std::sqrt(1.0 - conic.one_plus_conic_constant * c * c * rho * rho);
  Point point{c * rho * rho / (1.0 + root), c * rho / root, c / (root * root * root)};
  double power = rho * rho;  // rho^(exponent - 2)
  double exponent = 4.0;
  for (const double coefficient : conic.coefficients) {
    point.sag += coefficient * power * rho * rho;
    point.slope += exponent * coefficient * power * rho;
    point.curvature += exponent * (exponent - 1.0) * coefficient * power;
    power *= rho * rho;
    exponent += 2.0;
  }
  return point;
}

MirrorProfile::Point MirrorProfile::evaluate(const Spline& spline, double rho) {
  const auto above = std::upper_bound(spline.rho.begin() + 1, spline.rho.end() - 1, rho);
  const auto i = static_cast<std::size_t>(above - spline.rho.begin()) - 1;
  const double step = spline.rho[i + 1] - spline.rho[i];
  const double to_left = rho - spline.rho[i];
  const double to_right = spline.rho[i + 1] - rho;
  const double left = spline.second_derivative[i];
  const double right = spline.second_derivative[i + 1];
  const double left_value = spline.sag[i] / step - left * step / 6.0;
  const double right_value = spline.sag[i + 1] / step - right * step / 6.0;
  return {
      (left * to_right * to_right * to_right + right * to_left * to_left * to_left) / (6.0 * step) +
          left_value * to_right + right_value * to_left,
      (right * to_left * to_left - left * to_right * to_right) / (2.0 * step) - left_value +
          right_value,
      (left * to_right + right * to_left) / step};
}

}  // namespace omnitag
