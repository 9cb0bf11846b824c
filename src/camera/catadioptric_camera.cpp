#include "camera/catadioptric_camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "camera/safeguarded_step.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// Samples of the profile that are checked before a mirror is accepted.
constexpr int kProfileSteps = 4096;
constexpr int kElevationSamples = 256;

/// A bound on Newton and bisection steps that is never reached in practice.
constexpr int kMaxIterations = 100;

/// Newton doubles the digits with every step: one this small, relative to the mirror, leaves an
/// error near the machine's precision, and the mirror's curvature is negligible along it.
constexpr double kSmallStep = 1e-8;

std::string text(double number) {
  std::ostringstream out;
  out << number;
  return out.str();
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Grows with the elevation of a direction that leads away from the axis: 0 toward the lens, 1
/// across the axis, 2 away from the lens. It replaces the angle, to avoid an arc tangent.
double elevationOf(const Eigen::Vector2d& direction) {
  return 1.0 + direction.y() / (std::abs(direction.x()) + std::abs(direction.y()));
}

}  // namespace

CatadioptricCamera::CatadioptricCamera(const ImageSize& image_size, const ImagePlane& image_plane,
                                       Mirror mirror)
    : CameraModel(image_size, image_plane),
      mirror_(std::move(mirror)),
      min_rho_(mirror_.profile.minRho()),
      max_rho_(mirror_.rim_radius) {
  findVisibleRim();
  checkRays();
  innermost_ = reflectAt(min_rho_);
  outermost_ = reflectAt(max_rho_);
  min_radius_ = min_rho_ / innermost_.origin.y();
  max_radius_ = max_rho_ / outermost_.origin.y();
  if (!imagePlane().isInvertibleUpTo(max_radius_)) {
    throw InputError(
        "lens.distortion: expected one that can be inverted up to the mirror's rim, found one that "
        "folds the image before");
  }
  tabulateReflections();
  hideHousing();
  tabulateRays();
}

void CatadioptricCamera::findVisibleRim() {
  const double last_rho = mirror_.profile.maxRho();
  if (!(max_rho_ > min_rho_ && max_rho_ <= last_rho && std::isfinite(max_rho_))) {
    throw InputError("mirror.rim_radius: expected within the mirror's profile, from " +
                     text(min_rho_) + " to " + text(last_rho) + ", found " +
                     text(mirror_.rim_radius));
  }
  // A rim a little beyond the silhouette, like the edge of a ball, is not an error.
  constexpr double kMostlyVisible = 0.98;
  double visible_rho = min_rho_;
  for (int i = 0; i <= kProfileSteps; ++i) {
    const double rho = min_rho_ + (mirror_.rim_radius - min_rho_) * i / kProfileSteps;
    const MirrorProfile::Point point = mirror_.profile.at(rho);
    const double height = mirror_.apex_distance + point.sag;
    const bool visible = height > 0.0 && height > rho * point.slope;
    if (!visible) break;
    visible_rho = rho;
  }
  if (!(visible_rho > kMostlyVisible * mirror_.rim_radius)) {
    throw InputError("mirror.rim_radius: expected at most " + text(visible_rho) +
                     ", as the lens sees no more of the mirror, found " + text(mirror_.rim_radius));
  }
  max_rho_ = visible_rho;
}

void CatadioptricCamera::checkRays() const {
  Eigen::Vector2d last_ray = reflectAt(min_rho_).ray;
  if (!(last_ray.x() >= 0.0)) {
    throw InputError(
        "mirror: expected a convex profile that reflects away from the axis, found rays that cross "
        "the axis");
  }
  for (int i = 1; i <= kProfileSteps; ++i) {
    const double rho = min_rho_ + (max_rho_ - min_rho_) * i / kProfileSteps;
    const Eigen::Vector2d ray = reflectAt(rho).ray;
    if (!(cross(last_ray, ray) > 0.0)) {
      throw InputError(
          "mirror: expected a convex profile whose reflected rays diverge, found rays that cross "
          "at rho " +
          text(rho));
    }
    last_ray = ray;
  }
}

void CatadioptricCamera::tabulateReflections() {
  first_elevation_ = elevationOf(innermost_.ray);
  const double last_elevation = elevationOf(outermost_.ray);
  elevation_step_ = (last_elevation - first_elevation_) / (kElevationSamples - 1);
  double low = min_rho_;
  for (int i = 0; i < kElevationSamples; ++i) {
    const double target = first_elevation_ + i * elevation_step_;
    double high = max_rho_;
    while (high - low > kSmallStep * max_rho_) {
      const double middle = 0.5 * (low + high);
      (elevationOf(reflectAt(middle).ray) < target ? low : high) = middle;
    }
    origin_by_elevation_.push_back(reflectAt(low).origin);
  }
}

void CatadioptricCamera::hideHousing() {
  const Eigen::Vector2d edge(mirror_.housing_radius, 0.0);
  // The innermost ray may already miss the housing.
  if (edge.x() <= min_rho_ || innermost_.turnTo(edge) >= 0.0) return;
  const std::optional<RadialImage> image = imageFromPoint(edge.x(), edge.y());
  if (!image) {
    throw InputError(
        "lens.housing_radius: expected less than what the mirror shows beside the lens, found " +
        text(mirror_.housing_radius));
  }
  min_radius_ = image->radius;
  min_rho_ = rayFromRadius(image->radius)->origin.x();
  innermost_ = reflectAt(min_rho_);
}

CatadioptricCamera::Reflection CatadioptricCamera::reflectAt(double rho) const {
  // The lens's ray v = (rho, z) is reflected about the normal n = (slope, -1) to
  // v - 2 (v.n) / (n.n) n; multiplied by n.n, this needs no division.
  const MirrorProfile::Point point = mirror_.profile.at(rho);
  const double slope = point.slope;
  const double z = mirror_.apex_distance + point.sag;
  const double slope2 = slope * slope;
  return {{rho, z},
          slope,
          {rho * (1.0 - slope2) + 2.0 * z * slope, 2.0 * rho * slope - z * (1.0 - slope2)},
          {1.0 + slope2 + 2.0 * point.curvature * (z - rho * slope),
           slope * (1.0 + slope2) + 2.0 * point.curvature * (rho + z * slope)}};
}

double CatadioptricCamera::startingRho(const Eigen::Vector2d& point) const {
  // The elevation of a point, seen from its point of reflection, determines that point of
  // reflection. Seen from elsewhere on the mirror, it gives an estimate, from which the next one is
  // better.
  constexpr int kRounds = 2;
  Eigen::Vector2d origin = origin_by_elevation_[kElevationSamples / 2];
  for (int i = 0; i < kRounds; ++i) {
    const double position = (elevationOf(point - origin) - first_elevation_) / elevation_step_;
    if (!(position > 0.0)) return origin_by_elevation_.front().x();
    if (position >= kElevationSamples - 1) return origin_by_elevation_.back().x();
    const auto below = static_cast<std::size_t>(position);
    const double fraction = position - static_cast<double>(below);
    origin =
        (1.0 - fraction) * origin_by_elevation_[below] + fraction * origin_by_elevation_[below + 1];
  }
  return origin.x();
}

std::optional<RadialImage> CatadioptricCamera::imageFromPoint(double distance,
                                                              double height) const {
  if (!std::isfinite(distance) || !std::isfinite(height)) return std::nullopt;
  const Eigen::Vector2d point(distance, height);

  // The reflected ray leads away from the axis, so the point of reflection is nearer to the axis
  // than the point is.
  double low = min_rho_;
  double high = std::min(max_rho_, distance);
  if (high < low || innermost_.turnTo(point) > 0.0) return std::nullopt;
  if ((high == max_rho_ ? outermost_ : reflectAt(high)).turnTo(point) < 0.0) return std::nullopt;

  double rho = std::clamp(startingRho(point), low, high);
  for (int i = 0; i < kMaxIterations; ++i) {
    const Reflection reflection = reflectAt(rho);
    const double turn_by_rho = reflection.turnToByRho(point);
    const double step =
        safeguardedStep(rho, reflection.turnTo(point), turn_by_rho, &low, &high) - rho;
    rho += step;
    if (std::abs(step) > kSmallStep * max_rho_) continue;

    // A point on the mirror's surface, or on the axis behind it, is on no ray.
    if (!((point - reflection.origin).dot(reflection.ray) > 0.0)) return std::nullopt;
    const double z = reflection.origin.y() + reflection.slope * step;
    const double radius_by_rho = (z - rho * reflection.slope) / (z * z);
    return RadialImage{rho / z, -radius_by_rho * reflection.ray.y() / turn_by_rho,
                       radius_by_rho * reflection.ray.x() / turn_by_rho};
  }
  return std::nullopt;
}

std::optional<MeridionalRay> CatadioptricCamera::rayFromRadius(double radius) const {
  if (!(radius >= min_radius_ && radius <= max_radius_)) return std::nullopt;
  // The lens's ray at this radius meets the mirror where rho = radius * z(rho).
  double low = min_rho_;
  double high = max_rho_;
  double rho = std::clamp(radius * mirror_.apex_distance, low, high);
  for (int i = 0; i < kMaxIterations; ++i) {
    const MirrorProfile::Point point = mirror_.profile.at(rho);
    const double error = rho - radius * (mirror_.apex_distance + point.sag);
    const double next = safeguardedStep(rho, error, 1.0 - radius * point.slope, &low, &high);
    const double step = std::abs(next - rho);
    rho = next;
    if (step <= kSmallStep * max_rho_) break;
  }
  const Reflection reflection = reflectAt(rho);
  return MeridionalRay{reflection.origin, reflection.ray.normalized()};
}

}  // namespace omnitag
