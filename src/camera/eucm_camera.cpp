#include "camera/eucm_camera.h"

#include <cmath>

#include "camera/radial_field.h"

namespace omnitag {

EucmCamera::EucmCamera(const ImageSize& image_size, const ImagePlane& image_plane,
                       const Parameters& parameters, const FieldLimits& limits)
    : CentralCamera(image_size, image_plane,
                    fieldOf(Radius{parameters}, radiusOfImage(image_size, image_plane), limits,
                            "alpha, beta: expected an image")),
      inverse_({parameters}, maxAngle()) {
  tabulateRays();
}

ValueAndSlope EucmCamera::Radius::operator()(double angle) const {
  const auto& [alpha, beta] = parameters;
  const double across = std::sin(angle);
  const double along = std::cos(angle);
  const double distance = std::sqrt(beta * across * across + along * along);
  const double depth = alpha * distance + (1.0 - alpha) * along;
  if (!(depth > 0.0)) return {0.0, 0.0};
  const double depth_by_angle = across * (alpha * (beta - 1.0) * along / distance - (1.0 - alpha));
  return {across / depth, (along * depth - across * depth_by_angle) / (depth * depth)};
}

}  // namespace omnitag
