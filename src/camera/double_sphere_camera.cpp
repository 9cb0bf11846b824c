#include "camera/double_sphere_camera.h"

#include <cmath>

#include "camera/radial_field.h"

namespace omnitag {

DoubleSphereCamera::DoubleSphereCamera(const ImageSize& image_size, const ImagePlane& image_plane,
                                       const Parameters& parameters, const FieldLimits& limits)
    : CentralCamera(image_size, image_plane,
                    fieldOf(Radius{parameters}, radiusOfImage(image_size, image_plane), limits,
                            "xi, alpha: expected an image")),
      inverse_({parameters}, maxAngle()) {
  tabulateRays();
}

ValueAndSlope DoubleSphereCamera::Radius::operator()(double angle) const {
  const auto& [xi, alpha] = parameters;
  const double across = std::sin(angle);
  const double along = std::cos(angle);
  const double distance = std::hypot(across, along + xi);
  const double depth = alpha * distance + (1.0 - alpha) * (along + xi);
  if (!(depth > 0.0)) return {0.0, 0.0};
  const double depth_by_angle = -across * (alpha * xi / distance + 1.0 - alpha);
  return {across / depth, (along * depth - across * depth_by_angle) / (depth * depth)};
}

}  // namespace omnitag
