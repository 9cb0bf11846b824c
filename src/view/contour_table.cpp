#include "view/contour_table.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace omnitag {
namespace {

constexpr int kRadii = 384;
constexpr int kOffsets = 106;
constexpr double kOffsetStep = ContourTable::kMaxAzimuthOffset / (kOffsets - 1);
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

ContourTable::ContourTable(const CameraModel& camera, double distance)
    : distance_(distance),
      min_radius_(camera.minRadius()),
      max_radius_(camera.maxRadius()),
      radius_step_((max_radius_ - min_radius_) / (kRadii - 1)) {
  rays_.reserve(kRadii);
  for (int k = 0; k < kRadii; ++k) {
    // Rounding must not push the last radius beyond the camera's edge.
    rays_.push_back(*camera.rayFromRadius(std::min(min_radius_ + k * radius_step_, max_radius_)));
  }
  height_grows_ = rays_.back().direction.y() > rays_.front().direction.y();

  radii_.reserve(static_cast<std::size_t>(kRadii) * kOffsets);
  for (int offset = 0; offset < kOffsets; ++offset) {
    const double point_distance = distance / std::cos(offset * kOffsetStep);
    for (const MeridionalRay& ray : rays_) {
      // A ray along the axis never gets that far away from it.
      const bool reaches = ray.direction.x() > 1e-9;
      const std::optional<RadialImage> image =
          reaches ? camera.imageFromPoint(point_distance, ray.heightAt(distance)) : std::nullopt;
      radii_.push_back(static_cast<float>(image ? image->radius : kNaN));
    }
  }
}

double ContourTable::imageRadius(double distance, double height) const {
  // Height at a given distance is monotone in the radius, since rays do not cross in front of
  // the camera.
  const auto above = std::partition_point(
      rays_.begin(), rays_.end(), [this, distance, height](const MeridionalRay& ray) {
        const bool ray_is_outward = ray.direction.x() > 1e-9;
        if (!ray_is_outward) return true;
        return height_grows_ ? ray.heightAt(distance) < height : ray.heightAt(distance) > height;
      });
  if (above == rays_.begin() || above == rays_.end()) return kNaN;
  const auto below = above - 1;
  if (below->direction.x() <= 1e-9) return kNaN;
  const double low = below->heightAt(distance);
  const double fraction = (height - low) / (above->heightAt(distance) - low);
  return min_radius_ + radius_step_ * (static_cast<double>(below - rays_.begin()) + fraction);
}

double ContourTable::height(double radius, double distance) const {
  const double position = positionOf(std::clamp(radius, min_radius_, max_radius_));
  const auto k = std::min(static_cast<std::size_t>(position), rays_.size() - 2);
  const double fraction = position - static_cast<double>(k);
  return (1.0 - fraction) * rays_[k].heightAt(distance) +
         fraction * rays_[k + 1].heightAt(distance);
}

double ContourTable::radius(double radius_main, double azimuth_offset) const {
  return static_cast<double>(contours(azimuth_offset).radius(placeOf(radius_main)));
}

double ContourTable::radiusMain(double radius, double azimuth_offset) const {
  if (!(radius >= min_radius_ && radius <= max_radius_) ||
      std::abs(azimuth_offset) > kMaxAzimuthOffset) {
    return kNaN;
  }
  return imageRadius(distance_, height(radius, distance_ / std::cos(azimuth_offset)));
}

ContourTable::Contours ContourTable::contours(double azimuth_offset) const {
  const double position = std::abs(azimuth_offset) / kOffsetStep;
  Contours contours;
  if (!(position <= kOffsets - 1)) return contours;
  const int nearer = std::min(static_cast<int>(position), kOffsets - 2);
  contours.nearer_ = radii_.data() + static_cast<std::size_t>(nearer) * kRadii;
  contours.farther_ = contours.nearer_ + kRadii;
  contours.fraction_ = static_cast<float>(position - nearer);
  return contours;
}

ContourTable::Place ContourTable::placeOf(double radius_main) const {
  const double position = positionOf(radius_main);
  if (!(position >= 0.0 && position <= kRadii - 1)) return {};
  const int index = std::min(static_cast<int>(position), kRadii - 2);
  return {index, static_cast<float>(position - index)};
}

double ContourTable::positionOf(double radius) const {
  return (radius - min_radius_) / radius_step_;
}

}  // namespace omnitag
