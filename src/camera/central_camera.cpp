#include "camera/central_camera.h"

#include <algorithm>
#include <cmath>

namespace omnitag {

std::optional<RadialImage> CentralCamera::imageFromPoint(double distance, double height) const {
  if (!(distance >= 0.0) || !std::isfinite(distance) || !std::isfinite(height)) return std::nullopt;
  const double along = field_.through_mirror ? -height : height;
  const double square = distance * distance + height * height;
  const double angle = std::atan2(distance, along);
  if (!(square > 0.0) || angle > field_.max_angle) return std::nullopt;
  const ValueAndSlope radius = radiusAt(angle);
  const double by_height = -radius.slope * distance / square;
  return RadialImage{radius.value, radius.slope * along / square,
                     field_.through_mirror ? -by_height : by_height};
}

std::optional<MeridionalRay> CentralCamera::rayFromRadius(double radius) const {
  if (!(radius >= 0.0 && radius <= field_.max_radius)) return std::nullopt;
  const double angle = std::min(angleAt(radius), field_.max_angle);
  const double along = std::cos(angle);
  return MeridionalRay{Eigen::Vector2d::Zero(),
                       {std::sin(angle), field_.through_mirror ? -along : along}};
}

double CentralCamera::radiusOfImage(const ImageSize& image_size, const ImagePlane& image_plane) {
  double farthest = 0.0;
  for (const double u : {-0.5, image_size.width - 0.5}) {
    for (const double v : {-0.5, image_size.height - 0.5}) {
      const auto corner = image_plane.idealFromPixel({u, v});
      farthest =
          corner ? std::max(farthest, corner->norm()) : std::numeric_limits<double>::infinity();
    }
  }
  // Rounding must not put the corner itself out of the field.
  constexpr double kMargin = 1.0 + 1e-9;
  if (std::isfinite(farthest) && image_plane.isInvertibleUpTo(kMargin * farthest)) {
    return kMargin * farthest;
  }
  // No image of the world is this large in units of its focal length.
  double high = 1e3;
  double low = 0.0;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (image_plane.isInvertibleUpTo(middle) ? low : high) = middle;
  }
  return std::min(low, kMargin * farthest);
}

}  // namespace omnitag
