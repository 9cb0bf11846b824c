#pragma once

#include "camera/central_camera.h"

namespace omnitag {

/// The extended unified camera model (Khomutenko, Garcia, Martinet, *An Enhanced Unified Camera
/// Model*, 2016), as in Basalt and Kalibr's eucm-none: a direction is a point of the ellipsoid of
/// revolution beta (x^2 + y^2) + z^2 = 1. With d = sqrt(beta (x^2 + y^2) + z^2), the point of the
/// ideal image plane is (x, y) / (alpha d + (1 - alpha) z).
class EucmCamera final : public CentralCamera {
 public:
  struct Parameters {
    /// From 0 to 1.
    double alpha = 0.5;
    /// > 0.
    double beta = 1.0;
  };

  /// `image_plane` has no distortion. Throws InputError if the radius does not grow up to the angle
  /// that `limits` gives, or does not grow at all.
  EucmCamera(const ImageSize& image_size, const ImagePlane& image_plane,
             const Parameters& parameters, const FieldLimits& limits = {});

  const Parameters& parameters() const { return inverse_.function().parameters; }

 private:
  std::shared_ptr<CameraModel> copy() const override { return std::make_shared<EucmCamera>(*this); }

  struct Radius {
    Parameters parameters;
    /// The slope is 0 where the model has no image.
    ValueAndSlope operator()(double angle) const;
  };

  ValueAndSlope radiusAt(double angle) const override { return inverse_.function()(angle); }
  double angleAt(double radius) const override { return inverse_(radius); }

  InverseFunction<Radius> inverse_;
};

}  // namespace omnitag
