#include "omnitag/camera/equidistant_camera.h"

#include <sstream>

#include "omnitag/common/error.h"

namespace omnitag {

EquidistantCamera::EquidistantCamera(const ImageSize& image_size, const ImagePlane& image_plane,
                                     const Coefficients& coefficients, const FieldLimits& limits)
    : CentralCamera(image_size, image_plane,
                    fieldOf({coefficients}, radiusOfImage(image_size, image_plane), limits)),
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

CentralField EquidistantCamera::fieldOf(const Radius& radius, double image_radius,
                                        const FieldLimits& limits) {
  const double wanted = limits.max_angle.value_or(kLargestAngle);
  const double end = increasingUpTo(radius, wanted);
  if (!(end > 0.0) || (limits.max_angle && end < wanted)) {
    std::ostringstream message;
    message << "distortion: expected one that grows with the angle off the axis";
    if (limits.max_angle) message << " up to max_angle, " << wanted << " rad";
    message << ", found one that folds the image at " << end << " rad";
    throw InputError(message.str());
  }
  CentralField field{end, radius(end).value, limits.through_mirror};
  if (image_radius < field.max_radius) {
    field.max_angle = InverseFunction<Radius>(radius, end)(image_radius);
    field.max_radius = image_radius;
  }
  return field;
}

}  // namespace omnitag
