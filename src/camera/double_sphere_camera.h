#pragma once

#include "camera/central_camera.h"

namespace omnitag {

/// The double sphere model (Usenko, Demmel, Cremers, *The Double Sphere Camera Model*, 2018), as in
/// Basalt and Kalibr's ds-none: a direction is a point of a unit sphere; seen from xi behind that
/// sphere's centre it is a point of a second one, which images from alpha / (1 - alpha) behind the
/// second one's centre. With d = sqrt(x^2 + y^2 + (z + xi)^2) of a direction (x, y, z) of length 1,
/// the point of the ideal image plane is (x, y) / (alpha d + (1 - alpha) (z + xi)).
class DoubleSphereCamera final : public CentralCamera {
 public:
  struct Parameters {
    /// > -1.
    double xi = 0.0;
    /// From 0 to 1.
    double alpha = 0.5;
  };

  /// `image_plane` has no distortion. Throws InputError if the radius does not grow up to the angle
  /// that `limits` gives, or does not grow at all.
  DoubleSphereCamera(const ImageSize& image_size, const ImagePlane& image_plane,
                     const Parameters& parameters, const FieldLimits& limits = {});

  const Parameters& parameters() const { return inverse_.function().parameters; }

 private:
  std::shared_ptr<CameraModel> copy() const override {
    return std::make_shared<DoubleSphereCamera>(*this);
  }

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
