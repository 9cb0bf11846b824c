#include "omnitag/localization/look_around.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace omnitag {
namespace {

/// From least to most.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

/// m, of all markers with their white borders, in the map.
Range heightsOf(const MarkerMap& map) {
  constexpr double kWithBorder = 1.2;
  Range heights;
  for (const Marker& marker : map.markers) {
    for (const Eigen::Vector3d& corner : marker.corners()) {
      heights.include(marker.center().z() + kWithBorder * (corner - marker.center()).z());
    }
  }
  return heights;
}

/// Where a point images, or the edge of the field that is nearest to it.
double nearestRadius(const CameraModel& camera, double distance, double height) {
  if (const auto image = camera.imageFromPoint(distance, height)) return image->radius;
  const auto off = [&](double radius) {
    const std::optional<MeridionalRay> ray = camera.rayFromRadius(radius);
    return ray ? std::abs(ray->heightAt(distance) - height)
               : std::numeric_limits<double>::infinity();
  };
  const bool is_inside = off(camera.minRadius()) < off(camera.maxRadius());
  return is_inside ? camera.minRadius() : camera.maxRadius();
}

/// Radii of the ideal image plane at which something between these heights can image.
Range radiiOf(const Range& heights, const MountedCamera& camera, double min_range,
              double max_range) {
  constexpr int kSteps = 64;
  const Eigen::Isometry3d& base_from_camera = camera.baseFromCamera();
  const double axis_height = base_from_camera.linear()(2, 2);
  const double tilt = std::acos(std::min(1.0, std::abs(axis_height)));
  const double along_axis = axis_height > 0.0 ? 1.0 : -1.0;
  Range radii;
  for (int i = 0; i <= kSteps; ++i) {
    const double distance = min_range * std::pow(max_range / min_range, 1.0 * i / kSteps);
    for (const double height : {heights.low, heights.high}) {
      const double above_camera = height - base_from_camera.translation().z();
      const double range = std::hypot(distance, above_camera);
      // A tilted axis sees the same elevation higher on one side and lower on the other.
      for (const double turn : {-tilt, tilt}) {
        const double elevation = std::atan2(above_camera, distance) + turn;
        radii.include(nearestRadius(camera.model(), range * std::cos(elevation),
                                    along_axis * range * std::sin(elevation)));
      }
    }
  }
  return radii;
}

}  // namespace

LookAroundConfig readLookAroundConfig(const YamlReader& reader) {
  reader.allowOnly({"step", "overlap", "min_range", "oversampling", "max_size"});
  LookAroundConfig config;
  reader.read("step", &config.step, {radians(5.0), radians(90.0)});
  reader.read("overlap", &config.overlap, {0.0, radians(60.0)});
  reader.read("min_range", &config.min_range, kPositive);
  reader.read("oversampling", &config.oversampling, {0.25, 8.0});
  reader.read("max_size", &config.max_size, {32, 4096});
  return config;
}

std::vector<View> viewsAllAround(const MarkerMap& map, const MountedCamera& camera,
                                 const ContourTable& table, double max_range,
                                 const LookAroundConfig& config) {
  const Range radii =
      radiiOf(heightsOf(map), camera, config.min_range, std::max(max_range, config.min_range));
  if (!(radii.low < radii.high)) return {};

  ViewPlannerConfig planner;
  planner.oversampling = config.oversampling;
  planner.max_size = config.max_size;
  ViewTarget target;
  target.half_width =
      std::min(0.5 * (config.step + config.overlap), ContourTable::kMaxAzimuthOffset);
  target.min_radius = radii.low;
  target.max_radius = radii.high;
  target.distance = table.distance();
  std::vector<View> views;
  const int count = static_cast<int>(std::ceil(2.0 * kPi / config.step - 1e-6));
  for (int i = 0; i < count; ++i) {
    target.azimuth = normalizeAngle(2.0 * kPi * i / count);
    views.push_back(
        planView(target, table, camera.model().imagePlane().scale(), camera.axisUp(), planner));
  }
  return views;
}

}  // namespace omnitag
