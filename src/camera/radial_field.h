#pragma once

#include <sstream>
#include <string>

#include "camera/central_camera.h"
#include "camera/increasing_function.h"
#include "omnitag/common/error.h"

namespace omnitag {

/// The field of a central camera whose radius is a function of the angle off the axis: as far as
/// the radius grows, `limits` allow, and the image reaches (`image_radius`). Throws InputError,
/// which begins with `parameters`, if the radius does not grow up to the angle that `limits` gives,
/// or at all.
template <typename Radius>
CentralField fieldOf(const Radius& radius, double image_radius, const FieldLimits& limits,
                     const std::string& parameters) {
  const double wanted = limits.max_angle.value_or(CentralCamera::kLargestAngle);
  const double end = increasingUpTo(radius, wanted);
  if (!(end > 0.0) || (limits.max_angle && end < wanted)) {
    std::ostringstream message;
    message << parameters << " that grows with the angle off the axis";
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
