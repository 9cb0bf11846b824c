#pragma once

#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>
#include <unsupported/Eigen/Polynomials>

#include "camera/ocam_calibration.h"

/// The definitions of the OCamCalib toolbox, written down from its documentation in its own
/// conventions: x along the rows, y along the columns, the image's middle at -z, pixels (row,
/// column). Points are given in the optical frame, pixels as (u, v).
namespace omnitag::test {

/// cam2world: the direction of a pixel, of length 1.
inline Eigen::Vector3d cam2world(const OcamCalibration& model, const Eigen::Vector2d& pixel) {
  const double row = pixel.y() - model.center_row;
  const double column = pixel.x() - model.center_column;
  const double inverse_determinant = 1.0 / (model.c - model.d * model.e);
  const double x = inverse_determinant * (row - model.d * column);
  const double y = inverse_determinant * (-model.e * row + model.c * column);
  const double r = std::sqrt(x * x + y * y);
  double z = 0.0;
  for (std::size_t i = 0; i < model.polynomial.size(); ++i) {
    z += model.polynomial[i] * std::pow(r, static_cast<double>(i));
  }
  return Eigen::Vector3d(y, x, -z).normalized();
}

/// world2cam: the smallest positive root of f(rho) = rho z / sqrt(x^2 + y^2).
inline std::optional<Eigen::Vector2d> world2cam(const OcamCalibration& model,
                                                const Eigen::Vector3d& point) {
  const double x = point.y();
  const double y = point.x();
  const double z = -point.z();
  const double norm = std::sqrt(x * x + y * y);
  Eigen::VectorXd polynomial(static_cast<Eigen::Index>(model.polynomial.size()));
  for (Eigen::Index i = 0; i < polynomial.size(); ++i) {
    polynomial(i) = model.polynomial[static_cast<std::size_t>(i)];
  }
  polynomial(1) -= z / norm;
  const Eigen::PolynomialSolver<double, Eigen::Dynamic> solver(polynomial);
  double rho = std::numeric_limits<double>::infinity();
  const Eigen::VectorXcd& roots = solver.roots();
  for (Eigen::Index i = 0; i < roots.size(); ++i) {
    const std::complex<double> root = roots(i);
    const bool is_real = std::abs(root.imag()) < 1e-9 * std::abs(root);
    if (is_real && root.real() > 0.0) rho = std::min(rho, root.real());
  }
  if (!std::isfinite(rho)) return std::nullopt;
  const double along_x = x / norm * rho;
  const double along_y = y / norm * rho;
  const double row = along_x * model.c + along_y * model.d + model.center_row;
  const double column = along_x * model.e + along_y + model.center_column;
  return Eigen::Vector2d(column, row);
}

}  // namespace omnitag::test
