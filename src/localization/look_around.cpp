#include "localization/look_around.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/bounds.h"
#include "common/yaml_reader.h"

namespace omnitag {
namespace {

/// The radius at which a point images, or the nearest edge of the field.
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

/// Adds the radii of the ideal image plane at which something at a height above the camera can
/// image if it is `min_range` to `max_range` metres away.
void includeRadii(double above_camera, double min_range, double max_range,
                  const MountedCamera& camera, Bounds* radii) {
  constexpr int kSteps = 64;
  const double axis_height = camera.baseFromCamera().linear()(2, 2);
  const double tilt = std::acos(std::min(1.0, std::abs(axis_height)));
  const double along_axis = axis_height > 0.0 ? 1.0 : -1.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double distance = min_range * std::pow(max_range / min_range, 1.0 * i / kSteps);
    const double range = std::hypot(distance, above_camera);
    // A tilted axis sees the same elevation higher on one side and lower on the other.
    for (const double turn : {-tilt, tilt}) {
      const double elevation = std::atan2(above_camera, distance) + turn;
      radii->include(nearestRadius(camera.model(), range * std::cos(elevation),
                                   along_axis * range * std::sin(elevation)));
    }
  }
}

/// m: the range at which the smallest upright marker is a third wider than `overlap`. In five of
/// six directions it is still whole in a view there.
double nearestRange(const MarkerHeights& heights, double overlap) {
  constexpr double kNarrowest = radians(1.0);
  constexpr double kWider = 4.0 / 3.0;
  return 0.5 * heights.smallest_upright / std::tan(0.5 * kWider * std::max(overlap, kNarrowest));
}

/// Radii of the ideal image plane at which markers can image, except for lying ones near the axis.
Bounds radiiOf(const MarkerHeights& heights, const MountedCamera& camera, double max_range,
               double overlap) {
  const double camera_height = camera.baseFromCamera().translation().z();
  Bounds radii;
  if (!heights.upright.isEmpty()) {
    const double min_range = nearestRange(heights, overlap);
    for (const double height : {heights.upright.low, heights.upright.high}) {
      includeRadii(height - camera_height, min_range, std::max(min_range, max_range), camera,
                   &radii);
    }
  }
  if (!heights.lying.isEmpty()) {
    for (const double height : {heights.lying.low, heights.lying.high}) {
      const double above_camera = height - camera_height;
      const double nearest =
          std::max(std::abs(above_camera) * std::tan(kNearAxis), 1e-3 * max_range);
      includeRadii(above_camera, std::min(nearest, max_range), max_range, camera, &radii);
    }
  }
  return radii;
}

/// m: from here on, it hardly matters that a mirror has no single viewpoint.
constexpr double kFar = 10.0;

/// Whether the camera sees what is near the upper or the lower end of its axis. The camera's own
/// housing may hide what is exactly on it; what is near the other end is squeezed at a mirror's
/// rim, too much to be read.
bool seesEnd(bool up, const MountedCamera& camera) {
  const CameraModel& model = camera.model();
  const double along_axis = camera.axisUp() == up ? kFar : -kFar;
  if (model.imageFromPoint(0.0, along_axis)) return true;
  const auto edge =
      model.imageFromPoint(kFar * std::sin(kNearAxis), along_axis * std::cos(kNearAxis));
  return edge && edge->radius < 0.5 * (model.minRadius() + model.maxRadius());
}

/// Whether lying markers can be near the upper or the lower end of the axis.
bool canBeAtEnd(bool up, const MarkerHeights& heights, const MountedCamera& camera) {
  if (heights.lying.isEmpty()) return false;
  const double camera_height = camera.baseFromCamera().translation().z();
  return up ? heights.lying.high > camera_height : heights.lying.low < camera_height;
}

/// The radii at which the camera sees things that are not near the axis.
Bounds radiiOffAxis(const CameraModel& camera) {
  Bounds radii;
  for (const double side : {-1.0, 1.0}) {
    radii.include(
        nearestRadius(camera, kFar * std::sin(kNearAxis), side * kFar * std::cos(kNearAxis)));
  }
  return radii;
}

/// The target of a view near the upper or the lower end of the optical axis.
ViewTarget targetAtEnd(bool up, const MountedCamera& camera, double distance, double overlap) {
  const double along_axis = camera.axisUp() == up ? 1.0 : -1.0;
  const auto edge = camera.model().imageFromPoint(distance * std::sin(kNearAxis),
                                                  along_axis * distance * std::cos(kNearAxis));
  const double radius = edge ? edge->radius : camera.model().maxRadius();
  ViewTarget target;
  target.distance = distance;
  target.cone = ViewCone{along_axis * Eigen::Vector3d::UnitZ(), kNearAxis + overlap,
                         camera.model().imagePlane().scale() * radius / std::sin(kNearAxis)};
  return target;
}

/// Plans views all around a ring of radii, and of the ends of the axis.
class Planner {
 public:
  Planner(const MountedCamera& camera, const ContourTable& table, const LookAroundConfig& config)
      : camera_(camera), table_(table), config_(config) {}

  void addRing(const Bounds& radii) {
    if (!(radii.low < radii.high)) return;
    ViewTarget target;
    target.half_width =
        std::min(0.5 * (config_.step + config_.overlap), ContourTable::kMaxAzimuthOffset);
    target.min_radius = radii.low;
    target.max_radius = radii.high;
    target.distance = table_.distance();
    const int count = static_cast<int>(std::ceil(2.0 * kPi / config_.step - 1e-6));
    for (int i = 0; i < count; ++i) {
      target.azimuth = normalizeAngle(2.0 * kPi * i / count);
      add(target);
    }
  }

  void addEnd(bool up) {
    if (seesEnd(up, camera_)) add(targetAtEnd(up, camera_, table_.distance(), config_.overlap));
  }

  std::vector<View> takeViews() { return std::move(views_); }

 private:
  void add(const ViewTarget& target) {
    ViewPlannerConfig planner;
    planner.oversampling = config_.oversampling;
    planner.max_size = config_.max_size;
    const double pixels_per_unit = camera_.model().imagePlane().scale();
    views_.push_back(planView(target, table_, pixels_per_unit, camera_.axisUp(), planner));
  }

  const MountedCamera& camera_;
  const ContourTable& table_;
  const LookAroundConfig& config_;
  std::vector<View> views_;
};

}  // namespace

LookAroundConfig readLookAroundConfig(const YamlReader& reader) {
  reader.refuseReplaced("min_range", "look_around/overlap (a marker's width in the image, rad)");
  reader.allowOnly({"glance", "step", "overlap", "oversampling", "max_size"});
  LookAroundConfig config;
  reader.read("glance", &config.glance);
  reader.read("step", &config.step, {radians(5.0), radians(90.0)});
  reader.read("overlap", &config.overlap, {0.0, radians(60.0)});
  reader.read("oversampling", &config.oversampling, {0.25, 8.0});
  reader.read("max_size", &config.max_size, {32, 4096});
  return config;
}

std::optional<Annulus> annulusOfMarkers(const MarkerHeights& heights, const MountedCamera& camera,
                                        double max_range, const LookAroundConfig& config) {
  for (const bool up : {true, false}) {
    if (canBeAtEnd(up, heights, camera) && seesEnd(up, camera)) return Annulus{};
  }
  const Bounds radii = radiiOf(heights, camera, max_range, config.overlap);
  if (!(radii.low < radii.high)) return std::nullopt;
  return Annulus{radii.low, radii.high};
}

Annulus annulusOfEverything(const MountedCamera& camera) {
  if (seesEnd(true, camera) || seesEnd(false, camera)) return {};
  const Bounds radii = radiiOffAxis(camera.model());
  return {radii.low, radii.high};
}

std::vector<View> viewsAllAround(const MarkerHeights& heights, const MountedCamera& camera,
                                 const ContourTable& table, double max_range,
                                 const LookAroundConfig& config) {
  Planner planner(camera, table, config);
  Bounds radii = radiiOf(heights, camera, max_range, config.overlap);
  // A lens that looks ahead sees markers on walls near its axis.
  const Bounds off_axis = radiiOffAxis(camera.model());
  const bool is_lens = camera.model().imageFromPoint(0.0, kFar).has_value();
  const bool are_near_axis = is_lens && radii.low < off_axis.low;
  if (are_near_axis) radii.low = off_axis.low;
  planner.addRing(radii);
  for (const bool up : {true, false}) {
    const bool is_ahead = camera.axisUp() == up;
    if (canBeAtEnd(up, heights, camera) || (is_ahead && are_near_axis)) planner.addEnd(up);
  }
  return planner.takeViews();
}

std::vector<View> viewsOfEverything(const MountedCamera& camera, const ContourTable& table,
                                    const LookAroundConfig& config) {
  Planner planner(camera, table, config);
  planner.addRing(radiiOffAxis(camera.model()));
  for (const bool up : {true, false}) planner.addEnd(up);
  return planner.takeViews();
}

std::vector<MarkerReading> readEverything(const MarkerReader& reader, const MountedCamera& camera,
                                          const cv::Mat& panorama, LookAroundConfig config) {
  constexpr int kAllThatIsResolved = 4096;  // pixels
  config.max_size = kAllThatIsResolved;
  const std::vector<View> views = viewsOfEverything(camera, reader.warper().table(), config);
  std::vector<MarkerReading> readings;
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (MarkerReading& reading : reader.read(reader.warper().warp(panorama, views[v]), views[v])) {
      reading.view = v;
      readings.push_back(std::move(reading));
    }
  }
  return withoutRepetitions(readings, views, reader.warper());
}

}  // namespace omnitag
