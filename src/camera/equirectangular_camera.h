#pragma once

#include "camera/central_camera.h"

namespace omnitag {

/// The whole sphere as a panorama, without a lens: pixel (u, v) looks along the longitude
/// 2 pi (u + 0.5) / width - pi, about y from z toward x, and along the latitude
/// pi / 2 - pi (v + 0.5) / height, positive upward, toward -y. It fits radial symmetry about the
/// optical axis: in the ideal plane a direction images as far from the origin as it lies off the
/// axis, and the image plane does the rest.
///
/// The image's left and right edges are the same line, straight behind; an object across it is seen
/// in two pieces. The direction straight behind, which has no single point in the ideal plane, is
/// not seen at all.
class EquirectangularCamera final : public CentralCamera {
 public:
  explicit EquirectangularCamera(const ImageSize& image_size);

 private:
  std::shared_ptr<CameraModel> copy() const override {
    return std::make_shared<EquirectangularCamera>(*this);
  }

  ValueAndSlope radiusAt(double angle) const override { return {angle, 1.0}; }
  double angleAt(double radius) const override { return radius; }
};

}  // namespace omnitag
