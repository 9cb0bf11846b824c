#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// A number that a calibration may change.
struct CalibrationParameter {
  /// For a camera: the key in its file, or the name of a coefficient, e.g. "k1".
  std::string name;
  /// "px", "m", "rad" or empty.
  std::string unit;
  /// The guess.
  double value = 0.0;
  /// Typical error of a guess; the unit of the solver and of numeric derivatives.
  double scale = 1.0;
  /// Standard deviation beyond which images are considered not to determine it.
  double tolerable = 1.0;
};

/// The parameters' values, in their order.
Eigen::VectorXd valuesOf(const std::vector<CalibrationParameter>& parameters);

/// A camera file whose parameters can be replaced, so whatever is optimized can be written, read
/// again and used.
///
/// The parameters are the lens's fx, fy, cx and cy; for a mirror, radius_of_curvature,
/// conic_constant and apex_distance (only apex_distance if it is tabulated); for the equidistant
/// model, k1 to k4; for other models, those present of xi, alpha, beta, k1, k2, p1 and p2. Those of
/// the ocam model are cx and cy, the coefficients a0, a2, ... and the affine c, d and e; text()
/// then has the calibration in the file itself. Everything else stays as in the file.
class CameraTemplate {
 public:
  /// Throws InputError if the file does not describe a camera, or if its model cannot
  /// be calibrated.
  static CameraTemplate fromFile(const std::string& path);

  /// The same from text; errors name `origin` instead of a file.
  static CameraTemplate fromText(const std::string& text, const std::string& origin);

  const std::string& origin() const { return origin_; }
  const std::vector<CalibrationParameter>& parameters() const { return parameters_; }
  bool hasMirror() const { return has_mirror_; }

  /// Radius of the camera's visible circle in the image according to the file, in pixels.
  double circle() const { return circle_; }

  /// Whether the file's profile implies the conic constant (spherical, parabolic).
  bool impliesConicConstant() const { return implies_conic_constant_; }

  /// The camera with these values, in the order of parameters(). Throws InputError if they are
  /// not valid.
  std::shared_ptr<const CameraModel> camera(const Eigen::VectorXd& values) const;

  /// The same with a mirror extended beyond its rim and without the lens's housing: with wrong
  /// values, what the mirror shows may seem to lie beyond the rim.
  std::shared_ptr<const CameraModel> widened(const Eigen::VectorXd& values) const;

  /// The camera file with these values, in full precision. `rim_radius` (m) and `uncertainty` (to a
  /// thousandth of a pixel) replace those of the file.
  std::string text(const Eigen::VectorXd& values,
                   const std::optional<double>& rim_radius = std::nullopt,
                   const std::optional<CameraUncertainty>& uncertainty = std::nullopt) const;

  /// The rim (m) that images at this radius (pixels) about the lens's centre, at most the mirror's
  /// silhouette. Only for cameras with a mirror.
  double rimAt(const Eigen::VectorXd& values, double pixels) const;

 private:
  CameraTemplate(const YAML::Node& file, std::string origin);

  YAML::Node withValues(const Eigen::VectorXd& values) const;
  double silhouette(const Eigen::VectorXd& values) const;
  double valueOf(const Eigen::VectorXd& values, const std::string& name) const;

  YAML::Node file_;
  std::string origin_;
  std::vector<CalibrationParameter> parameters_;
  bool has_mirror_ = false;
  bool implies_conic_constant_ = false;
  /// Radius of the field in the image, in pixels.
  double circle_ = 0.0;
};

}  // namespace omnitag
