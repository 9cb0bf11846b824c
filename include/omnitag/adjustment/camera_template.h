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
  /// Of a camera: the key in its file, or the coefficient that it stands for, e.g. "k1".
  std::string name;
  /// "px", "m", "rad" or empty.
  std::string unit;
  /// The guess.
  double value = 0.0;
  /// By how much a guess may well be off; what the solver and numeric derivatives measure it in.
  double scale = 1.0;
  /// Standard deviation beyond which images are said not to tell it.
  double tolerable = 1.0;
};

/// The values of parameters, in their order.
Eigen::VectorXd valuesOf(const std::vector<CalibrationParameter>& parameters);

/// A camera file whose numbers may be replaced. What is optimized is therefore always what can be
/// written, read again and used.
///
/// The numbers are the lens's fx, fy, cx and cy and, of a mirror, radius_of_curvature,
/// conic_constant and apex_distance (of a tabulated one apex_distance alone), of the equidistant
/// model k1 to k4, of others what they have of xi, alpha, beta, k1, k2, p1 and p2. The rest stays
/// as in the file.
class CameraTemplate {
 public:
  /// Throws InputError where the file describes no camera, or one whose model is not calibrated.
  static CameraTemplate fromFile(const std::string& path);

  /// The same from text; `origin` stands for the file name in errors.
  static CameraTemplate fromText(const std::string& text, const std::string& origin);

  const std::string& origin() const { return origin_; }
  const std::vector<CalibrationParameter>& parameters() const { return parameters_; }
  bool hasMirror() const { return has_mirror_; }

  /// Pixels: radius, in the image, of what the file says that the camera sees.
  double circle() const { return circle_; }

  /// Whether the file's profile implies the conic constant (spherical, parabolic).
  bool impliesConicConstant() const { return implies_conic_constant_; }

  /// The camera with these numbers, in the order of parameters(). Throws InputError where they
  /// make none.
  std::shared_ptr<const CameraModel> camera(const Eigen::VectorXd& values) const;

  /// The same with a mirror that goes on beyond its rim and without the lens's housing: while its
  /// numbers are wrong, what the mirror shows may seem to lie beyond the rim.
  std::shared_ptr<const CameraModel> widened(const Eigen::VectorXd& values) const;

  /// The camera file with these numbers, in full precision. `rim_radius` (m) and `uncertainty` (to
  /// a thousandth of a pixel) stand in place of the file's.
  std::string text(const Eigen::VectorXd& values,
                   const std::optional<double>& rim_radius = std::nullopt,
                   const std::optional<CameraUncertainty>& uncertainty = std::nullopt) const;

  /// The rim (m) that images at a radius (pixels) of the image about the lens's centre, at most the
  /// silhouette of the mirror. For cameras with a mirror only.
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
  /// Pixels, radius of the field in the image.
  double circle_ = 0.0;
};

}  // namespace omnitag
