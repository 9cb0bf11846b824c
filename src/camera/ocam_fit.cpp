#include "camera/ocam_fit.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "camera/increasing_function.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr int kLeastDegree = 4;
constexpr int kLargestDegree = 16;

/// A camera's half-plane through the axis, sampled: angles off the axis (rad), radii (pixels), and
/// the derivatives of the radii with respect to the angle.
struct Profile {
  Eigen::ArrayXd angles;
  Eigen::ArrayXd radii;
  Eigen::ArrayXd growth;
};

/// `scale`: pixels per unit of the ideal plane.
Profile profileOf(const CentralCamera& camera, double scale) {
  constexpr int kSamples = 2000;
  Profile profile{Eigen::ArrayXd(kSamples), Eigen::ArrayXd(kSamples), Eigen::ArrayXd(kSamples)};
  for (int i = 0; i < kSamples; ++i) {
    const double angle = camera.maxAngle() * (i + 0.5) / kSamples;
    const double along = (camera.throughMirror() ? -1.0 : 1.0) * std::cos(angle);
    // At a distance of 1, the derivative by angle is the derivative along the tangent.
    const std::optional<RadialImage> image = camera.imageFromPoint(std::sin(angle), along);
    const double toward = camera.throughMirror() ? 1.0 : -1.0;
    profile.angles(i) = angle;
    profile.radii(i) = scale * image->radius;
    profile.growth(i) = scale * (image->radius_by_distance * std::cos(angle) +
                                 image->radius_by_height * toward * std::sin(angle));
  }
  return profile;
}

double valueOf(const std::vector<double>& polynomial, double x) {
  double value = 0.0;
  for (auto each = polynomial.rbegin(); each != polynomial.rend(); ++each)
    value = value * x + *each;
  return value;
}

/// A least-squares fit with a weight for each value.
std::vector<double> fitPolynomial(const Eigen::ArrayXd& x, const Eigen::ArrayXd& values,
                                  const Eigen::ArrayXd& weights, int degree) {
  const double unit = x.abs().maxCoeff();
  Eigen::MatrixXd powers(x.size(), degree + 1);
  powers.col(0).setOnes();
  for (int i = 1; i <= degree; ++i) powers.col(i) = powers.col(i - 1).array() * (x / unit);
  powers.array().colwise() *= weights;
  const Eigen::VectorXd fitted = powers.colPivHouseholderQr().solve((values * weights).matrix());
  std::vector<double> coefficients;
  for (int i = 0; i <= degree; ++i) coefficients.push_back(fitted(i) / std::pow(unit, i));
  return coefficients;
}

/// Raises the degree of a fit until it is good enough, and keeps the best polynomial. Returns its
/// error.
template <typename Fit, typename Error>
double growDegree(double tolerance, std::vector<double>* polynomial, const Fit& fit,
                  const Error& error_of) {
  double least = std::numeric_limits<double>::infinity();
  for (int degree = kLeastDegree; degree <= kLargestDegree && least > tolerance; ++degree) {
    const std::vector<double> candidate = fit(degree);
    const double error = error_of(candidate);
    if (!(error < least)) continue;
    least = error;
    *polynomial = candidate;
  }
  return least;
}

void writeNumbers(const std::vector<double>& numbers, std::ostream* out) {
  *out << numbers.size();
  for (const double number : numbers) *out << ' ' << number;
}

}  // namespace

OcamFit fitOcam(const CentralCamera& camera, double tolerance) {
  const ImagePlane& plane = camera.imagePlane();
  if (plane.isDistorted()) {
    throw InputError(
        "expected a camera whose image depends on the angle off its axis alone, as OCamCalib has "
        "it, found a distorted one");
  }
  const double scale = plane.affine()(0, 0);
  const Profile profile = profileOf(camera, scale);
  OcamFit fit;
  OcamCalibration& calibration = fit.calibration;
  calibration.center_column = plane.principalPoint().x();
  calibration.center_row = plane.principalPoint().y();
  calibration.c = plane.affine()(1, 1) / scale;
  calibration.d = plane.affine()(1, 0) / scale;
  calibration.e = plane.affine()(0, 1) / scale;
  calibration.image_size = camera.imageSize();

  // The toolbox's depth is negative in front of the camera.
  const Eigen::ArrayXd depths = -profile.radii / profile.angles.tan();
  const Eigen::ArrayXd pixels_by_depth =
      profile.growth * profile.radii / (profile.radii.square() + depths.square());
  const auto direct_error = [&](const std::vector<double>& polynomial) {
    double worst = 0.0;
    for (Eigen::Index i = 0; i < depths.size(); ++i) {
      const double depth = valueOf(polynomial, profile.radii(i));
      const double angle = std::atan2(profile.radii(i), -depth);
      worst = std::max(worst, std::abs(angle - profile.angles(i)) * profile.growth(i));
    }
    return worst;
  };
  const double direct = growDegree(
      tolerance, &calibration.polynomial,
      [&](int degree) { return fitPolynomial(profile.radii, depths, pixels_by_depth, degree); },
      direct_error);

  const Eigen::ArrayXd elevations = profile.angles - 0.5 * kPi;
  const Eigen::ArrayXd ones = Eigen::ArrayXd::Ones(elevations.size());
  const double inverse = growDegree(
      tolerance, &fit.inverse,
      [&](int degree) { return fitPolynomial(elevations, profile.radii, ones, degree); },
      [&](const std::vector<double>& polynomial) {
        double worst = 0.0;
        for (Eigen::Index i = 0; i < elevations.size(); ++i) {
          worst = std::max(worst, std::abs(valueOf(polynomial, elevations(i)) - profile.radii(i)));
        }
        return worst;
      });
  fit.error = std::max(direct, inverse);
  return fit;
}

std::string ocamText(const OcamFit& fit) {
  constexpr int kAllDigits = 17;
  const OcamCalibration& calibration = fit.calibration;
  std::ostringstream text;
  text << std::setprecision(kAllDigits);
  text << "#polynomial coefficients, from pixels to rays\n\n";
  writeNumbers(calibration.polynomial, &text);
  text << "\n\n#polynomial coefficients, from points to pixels\n\n";
  writeNumbers(fit.inverse, &text);
  text << "\n\n#center: row and column, from 0\n\n"
       << calibration.center_row << ' ' << calibration.center_column
       << "\n\n#affine parameters c, d, e\n\n"
       << calibration.c << ' ' << calibration.d << ' ' << calibration.e
       << "\n\n#image size: height and width\n\n"
       << calibration.image_size.height << ' ' << calibration.image_size.width << '\n';
  return text.str();
}

}  // namespace omnitag
