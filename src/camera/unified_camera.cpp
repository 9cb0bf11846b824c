#include "camera/unified_camera.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// The radius's derivative is (1 + xi cos) / (cos + xi)^2.
ValueAndSlope radiusOf(double angle, double xi) {
  const double along = std::cos(angle);
  const double depth = along + xi;
  return {std::sin(angle) / depth, (1.0 + xi * along) / (depth * depth)};
}

double angleOf(double radius, double xi) {
  // The sphere's point (scale * radius, scale - xi) has length 1.
  const double square = radius * radius;
  const double root = std::sqrt(std::max(0.0, 1.0 + (1.0 - xi * xi) * square));
  const double scale = (xi + root) / (1.0 + square);
  return std::atan2(scale * radius, scale - xi);
}

/// The angle up to which the radius grows: beyond it the radius decreases (xi > 1) or does
/// not exist.
double foldOf(double xi) { return std::acos(-(xi > 1.0 ? 1.0 / xi : xi)); }

[[noreturn]] void refuse(const std::string& key, const std::string& what, double wanted,
                         double fold) {
  std::ostringstream message;
  message << key << ": expected " << what << " up to max_angle, " << wanted
          << " rad, found that it folds the image at " << fold << " rad";
  throw InputError(message.str());
}

}  // namespace

UnifiedCamera::UnifiedCamera(const ImageSize& image_size, const ImagePlane& image_plane, double xi,
                             const FieldLimits& limits)
    : CentralCamera(image_size, image_plane,
                    fieldOf(image_plane, radiusOfImage(image_size, image_plane), xi, limits)),
      xi_(xi) {
  tabulateRays();
}

CentralField UnifiedCamera::fieldOf(const ImagePlane& image_plane, double image_radius, double xi,
                                    const FieldLimits& limits) {
  // At the fold itself the radius has no slope, or is infinite.
  constexpr double kBeforeFold = 1e-4;
  const double fold = foldOf(xi);
  const double last = std::min(fold - kBeforeFold, kLargestAngle);
  const double wanted = limits.max_angle.value_or(last);
  if (wanted > last) refuse("xi", "one whose image grows with the angle", wanted, fold);
  const double radius = radiusOf(wanted, xi).value;
  if (limits.max_angle && !image_plane.isInvertibleUpTo(radius)) {
    refuse("distortion", "one that can be inverted", wanted, angleOf(image_radius, xi));
  }
  if (image_radius < radius) {
    return {angleOf(image_radius, xi), image_radius, limits.through_mirror};
  }
  return {wanted, radius, limits.through_mirror};
}

ValueAndSlope UnifiedCamera::radiusAt(double angle) const { return radiusOf(angle, xi_); }

double UnifiedCamera::angleAt(double radius) const { return angleOf(radius, xi_); }

}  // namespace omnitag
