#pragma once

#include <Eigen/Core>
#include <utility>
#include <variant>
#include <vector>

namespace omnitag {

/// The meridian of a mirror that is a surface of revolution: its sag, in metres along the optical
/// axis, counted from the apex away from the lens, at a distance rho from the axis.
class MirrorProfile {
 public:
  /// Sag (m), slope d sag / d rho and curvature d^2 sag / d rho^2 (1/m).
  struct Point {
    double sag;
    double slope;
    double curvature;
  };

  /// The standard form of optical design:
  /// sag = c rho^2 / (1 + sqrt(1 - (1 + K) c^2 rho^2)) + a4 rho^4 + a6 rho^6 + ...
  /// with c = 1 / radius_of_curvature (m, > 0: convex toward the lens) and K the conic constant:
  /// 0 a sphere, -1 a paraboloid, below -1 a hyperboloid. `coefficients` are a4, a6, ...
  static MirrorProfile conic(double radius_of_curvature, double conic_constant,
                             std::vector<double> coefficients = {});

  /// A smooth curve through samples (rho, sag) in metres: the cubic spline whose slope on the axis
  /// is zero. If the first sample is off the axis, the profile begins there. Throws InputError
  /// unless there are at least four samples, all finite, rho increasing from >= 0.
  static MirrorProfile tabulated(const std::vector<Eigen::Vector2d>& samples);

  /// Valid for rho in [minRho(), maxRho()].
  Point at(double rho) const;

  /// The profile's domain, in metres from the axis. The conic is unbounded if K <= -1.
  double minRho() const;
  double maxRho() const;

 private:
  struct Conic {
    double curvature;
    double one_plus_conic_constant;
    std::vector<double> coefficients;
  };
  /// One cubic of the spline, in powers of rho - start; it ends where the next one starts.
  struct Piece {
    double start;
    double sag;
    double slope;
    double quadratic;
    double cubic;
  };
  struct Spline {
    std::vector<Piece> pieces;
    double end = 0.0;
  };

  explicit MirrorProfile(std::variant<Conic, Spline> shape) : shape_(std::move(shape)) {}
  static Point evaluate(const Conic& conic, double rho);
  static Point evaluate(const Spline& spline, double rho);
  static std::vector<double> secondDerivatives(const std::vector<Eigen::Vector2d>& samples);

  std::variant<Conic, Spline> shape_;
};

}  // namespace omnitag
