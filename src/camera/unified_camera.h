#pragma once

#include "camera/central_camera.h"

namespace omnitag {

/// Mei's unified model, as in OpenCV's omnidir module and Kalibr's omni-radtan: a direction is a
/// point of the unit sphere, seen from a point xi behind the sphere's centre. In the ideal image
/// plane, which the lens distorts, it images at (x, y) / (z + xi).
class UnifiedCamera final : public CentralCamera {
 public:
  /// `xi` >= 0; `image_plane` carries the lens's distortion k1, k2, p1, p2 and its skew. Throws
  /// InputError if the model or the distortion folds before the angle that `limits` gives.
  UnifiedCamera(const ImageSize& image_size, const ImagePlane& image_plane, double xi,
                const FieldLimits& limits = {});

  double xi() const { return xi_; }

 private:
  std::shared_ptr<CameraModel> copy() const override {
    return std::make_shared<UnifiedCamera>(*this);
  }

  static CentralField fieldOf(const ImagePlane& image_plane, double image_radius, double xi,
                              const FieldLimits& limits);
  ValueAndSlope radiusAt(double angle) const override;
  double angleAt(double radius) const override;

  double xi_;
};

}  // namespace omnitag
