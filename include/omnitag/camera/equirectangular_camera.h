#pragma once

#include "omnitag/camera/central_camera.h"

namespace omnitag {

/// A whole sphere as a panorama, without a lens: pixel (u, v) looks along the longitude
/// 2 pi (u + 0.5) / width - pi, about y from z toward x, and the latitude pi / 2 - pi (v + 0.5) /
/// height, upward: toward -y. So it is about the optical axis, too: a direction images in the ideal
/// plane as far from the origin as it lies off the axis, and the image plane does the rest.
///
/// The image's left and right edge are one line, straight behind; what lies across it is not seen
/// in one piece. The direction straight behind, where the ideal plane has no single point, is not
/// seen at all.
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
