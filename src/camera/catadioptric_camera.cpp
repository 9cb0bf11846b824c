#include "omnitag/camera/catadioptric_camera.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr int kElevationSamples = 256;

std::string millimetres(double metres) { return std::to_string(metres * 1e3) + " mm"; }

}  // namespace

CatadioptricCamera::CatadioptricCamera(const ImageSize& image_size, const ImagePlane& image_plane,
                                       Mirror mirror)
    : CameraModel(image_size, image_plane),
      mirror_(std::move(mirror)),
      min_rho_(mirror_.profile.minRho()) {
  if (mirror_.rim_radius <= min_rho_ || mirror_.rim_radius > mirror_.profile.maxRho() ||
      !std::isfinite(mirror_.profile.at(mirror_.rim_radius).slope)) {
    throw InputError("expected the rim within the mirror's profile, which ends at " +
                     millimetres(mirror_.profile.maxRho()) + ", found rim_radius " +
                     millimetres(mirror_.rim_radius));
  }
  checkRays();

  at_rim_ = reflectAt(mirror_.rim_radius);
  max_radius_ = mirror_.rim_radius / at_rim_.height;
  min_radius_ = min_rho_ / reflectAt(min_rho_).height;
  middle_rho_ = 0.5 * (min_rho_ + mirror_.rim_radius);
  middle_height_ = reflectAt(middle_rho_).height;
  if (!imagePlane().isInvertibleUpTo(max_radius_)) {
    throw InputError("expected a lens distortion that can be inverted up to the mirror's rim");
  }

  first_elevation_ = elevationAt(min_rho_);
  const double last_elevation = elevationAt(mirror_.rim_radius);
  elevation_step_ = (last_elevation - first_elevation_) / (kElevationSamples - 1);
  double low = min_rho_;
  for (int i = 0; i < kElevationSamples; ++i) {
    const double target = first_elevation_ + i * elevation_step_;
    double high = mirror_.rim_radius;
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      (elevationAt(middle) < target ? low : high) = middle;
    }
    rho_by_elevation_.push_back(low);
  }

  if (mirror_.housing_radius > 0.0) {
    const std::optional<RadialImage> edge = imageFromPoint(mirror_.housing_radius, 0.0);
    if (!edge) {
      throw InputError(
          "expected the mirror to reach beyond the camera's own image, found "
          "housing_radius " +
          millimetres(mirror_.housing_radius));
    }
    min_radius_ = edge->radius;
    min_rho_ = rayFromRadius(edge->radius)->origin.x();
  }
}

CatadioptricCamera::Reflection CatadioptricCamera::reflectAt(double rho) const {
  // In (distance from axis, height): the lens's ray v = (rho, z) is reflected about the normal
  // n = (slope, -1) to v - 2 (v.n)/(n.n) n = v - 2 k n.
  const MirrorProfile::Point point = mirror_.profile.at(rho);
  const double slope = point.slope;
  const double z = mirror_.apex_distance + point.sag;
  const double norm = 1.0 + slope * slope;
  const double k = (rho * slope - z) / norm;
  const double k_by_rho = point.curvature * (rho - 2.0 * slope * k) / norm;
  Reflection reflection;
  reflection.height = z;
  reflection.slope = slope;
  reflection.ray = {rho - 2.0 * k * slope, z + 2.0 * k};
  reflection.ray_by_rho = {1.0 - 2.0 * (k_by_rho * slope + k * point.curvature),
                           slope + 2.0 * k_by_rho};
  return reflection;
}

double CatadioptricCamera::elevationAt(double rho) const {
  const Reflection reflection = reflectAt(rho);
  return std::atan2(reflection.ray.x(), -reflection.ray.y());
}

void CatadioptricCamera::checkRays() const {
  constexpr int kSteps = 512;
  double last_radius = -1.0;
  double last_elevation = -1.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double rho = min_rho_ + (mirror_.rim_radius - min_rho_) * i / kSteps;
    const Reflection reflection = reflectAt(rho);
    const double radius = rho / reflection.height;
    const double elevation = std::atan2(reflection.ray.x(), -reflection.ray.y());
    if (!(reflection.height > 0.0) || !(radius > last_radius)) {
      throw InputError("expected a mirror that the lens sees up to its rim, found it hidden from " +
                       millimetres(rho) + " off the axis");
    }
    if (!(elevation > last_elevation)) {
      throw InputError(
          "expected a convex mirror whose reflected rays diverge, found rays that "
          "cross at " +
          millimetres(rho) + " off the axis");
    }
    last_radius = radius;
    last_elevation = elevation;
  }
}

double CatadioptricCamera::initialRho(double distance, double height) const {
  // As if all rays came from the middle of the mirror.
  const double elevation = std::atan2(distance - middle_rho_, middle_height_ - height);
  const double position = (elevation - first_elevation_) / elevation_step_;
  if (!(position > 0.0)) return rho_by_elevation_.front();
  if (position >= kElevationSamples - 1) return rho_by_elevation_.back();
  const auto i = static_cast<std::size_t>(position);
  const double fraction = position - static_cast<double>(i);
  return (1.0 - fraction) * rho_by_elevation_[i] + fraction * rho_by_elevation_[i + 1];
}

std::optional<RadialImage> CatadioptricCamera::imageFromPoint(double distance,
                                                              double height) const {
  // The reflected ray leaves the axis behind, so the point of reflection is nearer to it than the
  // point is. `turn` is the cross product of the way to the point and the reflected ray: negative
  // while rho is too small, zero where the law of reflection holds.
  const auto turnOf = [distance, height](double rho, const Reflection& reflection) {
    return (distance - rho) * reflection.ray.y() -
           (height - reflection.height) * reflection.ray.x();
  };
  double low = min_rho_;
  double high = std::min(mirror_.rim_radius, distance);
  if (high < low) return std::nullopt;
  if (turnOf(low, reflectAt(low)) > 0.0) return std::nullopt;
  const bool reaches_rim = high == mirror_.rim_radius;
  if (turnOf(high, reaches_rim ? at_rim_ : reflectAt(high)) < 0.0) return std::nullopt;

  // Newton doubles the digits with every step, so a step this small leaves no error that counts.
  constexpr int kMaxIterations = 60;
  const double tolerance = 1e-8 * mirror_.rim_radius;
  double rho = std::clamp(initialRho(distance, height), low, high);
  Reflection reflection = reflectAt(rho);
  double turn_by_rho = 0.0;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double turn = turnOf(rho, reflection);
    turn_by_rho = -reflection.ray.y() + (distance - rho) * reflection.ray_by_rho.y() +
                  reflection.slope * reflection.ray.x() -
                  (height - reflection.height) * reflection.ray_by_rho.x();
    (turn < 0.0 ? low : high) = rho;
    double next = rho - turn / turn_by_rho;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double step = std::abs(next - rho);
    rho = next;
    reflection = reflectAt(rho);
    if (step <= tolerance) break;
  }

  // What lies behind the mirror's surface meets the backward extension of a ray, or none.
  const Eigen::Vector2d way(distance - rho, height - reflection.height);
  constexpr double kParallel = 1e-6;
  const double along = way.dot(reflection.ray);
  if (!(along > 0.0) || std::abs(turnOf(rho, reflection)) > kParallel * along) return std::nullopt;

  const double z = reflection.height;
  const double radius_by_rho = (z - rho * reflection.slope) / (z * z);
  return RadialImage{rho / z, -radius_by_rho * reflection.ray.y() / turn_by_rho,
                     radius_by_rho * reflection.ray.x() / turn_by_rho};
}

std::optional<MeridionalRay> CatadioptricCamera::rayFromRadius(double radius) const {
  if (!(radius >= min_radius_ && radius <= max_radius_)) return std::nullopt;
  // The lens's ray at this radius meets the mirror where rho = radius * z(rho).
  constexpr int kMaxIterations = 60;
  const double tolerance = 1e-15 * mirror_.rim_radius;
  double low = min_rho_;
  double high = mirror_.rim_radius;
  double rho = std::clamp(radius * mirror_.apex_distance, low, high);
  for (int i = 0; i < kMaxIterations; ++i) {
    const MirrorProfile::Point point = mirror_.profile.at(rho);
    const double error = rho - radius * (mirror_.apex_distance + point.sag);
    (error < 0.0 ? low : high) = rho;
    double next = rho - error / (1.0 - radius * point.slope);
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double step = std::abs(next - rho);
    rho = next;
    if (step <= tolerance) break;
  }
  const Reflection reflection = reflectAt(rho);
  return MeridionalRay{{rho, reflection.height}, reflection.ray.normalized()};
}

}  // namespace omnitag
