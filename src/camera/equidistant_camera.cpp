#include "camera/equidistant_camera.h"

#include "camera/radial_field.h"

namespace omnitag {

EquidistantCamera::EquidistantCamera(const ImageSize& image_size, const ImagePlane& image_plane,
                                     const Coefficients& coefficients, const FieldLimits& limits)
    : CentralCamera(image_size, image_plane,
                    fieldOf(Radius{coefficients}, radiusOfImage(image_size, image_plane), limits,
                            "distortion: expected one")),
      inverse_({coefficients}, maxAngle()) {
  tabulateRays();
}

ValueAndSlope EquidistantCamera::Radius::operator()(double angle) const {
  const double square = angle * angle;
  const auto& [k1, k2, k3, k4] = k;
  return {
      angle * (1.0 + square * (k1 + square * (k2 + square * (k3 + square * k4)))),
      1.0 + square * (3.0 * k1 + square * (5.0 * k2 + square * (7.0 * k3 + square * 9.0 * k4)))};
}

}  // namespace omnitag
