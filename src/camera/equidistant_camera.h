#pragma once

#include <array>

#include "camera/central_camera.h"

namespace omnitag {

/// Kannala-Brandt, as in OpenCV's fisheye module, Kalibr's pinhole-equi and CameraInfo's
/// "equidistant": a direction theta off the optical axis images at the radius
/// theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8) of the ideal image plane.
class EquidistantCamera final : public CentralCamera {
 public:
  /// k1 to k4.
  using Coefficients = std::array<double, 4>;

  /// `image_plane` has no distortion of its own, but may have skew. Throws InputError if the radius
  /// does not grow up to the angle that `limits` gives, or does not grow at all.
  EquidistantCamera(const ImageSize& image_size, const ImagePlane& image_plane,
                    const Coefficients& coefficients, const FieldLimits& limits = {});

  const Coefficients& coefficients() const { return inverse_.function().k; }

 private:
  std::shared_ptr<CameraModel> copy() const override {
    return std::make_shared<EquidistantCamera>(*this);
  }

  struct Radius {
    Coefficients k;
    ValueAndSlope operator()(double angle) const;
  };

  ValueAndSlope radiusAt(double angle) const override { return inverse_.function()(angle); }
  double angleAt(double radius) const override { return inverse_(radius); }

  InverseFunction<Radius> inverse_;
};

}  // namespace omnitag
