#pragma once

#include <vector>

#include "camera/central_camera.h"
#include "camera/ocam_calibration.h"

namespace omnitag {

/// Scaramuzza's model, as his OCamCalib toolbox for Matlab fits it: the pixel at a distance rho
/// from the centre, after an affine correction, looks along (x, y, f(rho)), rho^2 = x^2 + y^2, with
/// f(rho) = a0 + a1 rho + a2 rho^2 + ...
///
/// The toolbox counts x along the rows, downward, and y along the columns, to the right, and the
/// middle of the image looks along its -z axis, since a0 < 0. In the optical frame, whose z axis
/// points out of the lens, its (x, y, z) are therefore (y, x, -z). The ideal image plane is the
/// toolbox's, in pixels, the axes named as in the optical frame.
class OcamCamera final : public CentralCamera {
 public:
  /// Throws InputError if the angle off the axis does not grow with the radius up to the angle that
  /// `limits` gives, or does not grow at all, or if the affine correction is singular or mirrors.
  explicit OcamCamera(const OcamCalibration& calibration, const FieldLimits& limits = {});

 private:
  std::shared_ptr<CameraModel> copy() const override { return std::make_shared<OcamCamera>(*this); }

  /// Angle off the axis as a function of the radius.
  struct Angle {
    std::vector<double> polynomial;
    ValueAndSlope operator()(double radius) const;
  };

  static ImagePlane imagePlaneOf(const OcamCalibration& calibration);
  static CentralField fieldOf(const Angle& angle, double image_radius, const FieldLimits& limits);
  ValueAndSlope radiusAt(double angle) const override;
  double angleAt(double radius) const override { return inverse_.function()(radius).value; }

  InverseFunction<Angle> inverse_;
};

}  // namespace omnitag
