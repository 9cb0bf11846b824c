#include "omnitag/calibration/ring_views.h"

#include <algorithm>
#include <cmath>

#include "omnitag/common/angle.h"
#include "omnitag/view/view_planner.h"

namespace omnitag {
namespace {

constexpr int kViews = 8;
/// rad, by which neighbouring views overlap: a marker that is narrower is whole in one of them.
constexpr double kOverlap = radians(20.0);

/// rad, above and below the plane across the axis: markers on walls are seldom higher or lower.
constexpr double kHighest = radians(60.0);

/// m. Far, as the paper's tables are.
constexpr double kFar = 10.0;

/// The radius of the ideal image plane at which a direction images, or the nearer end of the field.
double radiusAt(double elevation, const CameraModel& camera, double otherwise) {
  const auto image = camera.imageFromPoint(kFar * std::cos(elevation), kFar * std::sin(elevation));
  return image ? image->radius : otherwise;
}

ViewTarget targetAtEnd(double along_axis, const MountedCamera& camera, double distance) {
  const CameraModel& model = camera.model();
  const double radius = radiusAt(along_axis * (0.5 * kPi - kNearAxis), model, model.maxRadius());
  ViewTarget target;
  target.distance = distance;
  target.cone = ViewCone{along_axis * Eigen::Vector3d::UnitZ(), kNearAxis + kOverlap,
                         model.imagePlane().scale() * radius / std::sin(kNearAxis)};
  return target;
}

}  // namespace

std::vector<View> viewsOfRing(const MountedCamera& camera, const ContourTable& table,
                              bool shows_axis) {
  const CameraModel& model = camera.model();
  ViewPlannerConfig planner;
  planner.oversampling = 1.0;
  planner.max_size = 960;
  const auto plan = [&](const ViewTarget& target) {
    return planView(target, table, model.imagePlane().scale(), camera.axisUp(), planner);
  };
  // Radii grow with elevation along the axis, or fall: either end of the field may be the lower.
  const double middle = radiusAt(0.0, model, model.maxRadius());
  const auto endOf = [&](double elevation) {
    const bool grows =
        radiusAt(radians(5.0), model, middle) > radiusAt(radians(-5.0), model, middle);
    return radiusAt(elevation, model,
                    grows == (elevation > 0.0) ? model.maxRadius() : model.minRadius());
  };
  ViewTarget target;
  target.min_radius = std::min(endOf(-kHighest), endOf(kHighest));
  target.max_radius = std::max(endOf(-kHighest), endOf(kHighest));
  target.distance = table.distance();
  target.half_width = std::min(kPi / kViews + 0.5 * kOverlap, ContourTable::kMaxAzimuthOffset);
  std::vector<View> views;
  for (int i = 0; i < kViews; ++i) {
    target.azimuth = normalizeAngle(2.0 * kPi * i / kViews);
    views.push_back(plan(target));
  }
  for (const double along_axis : {1.0, -1.0}) {
    const bool is_seen = model.imageFromPoint(0.0, along_axis * kFar).has_value();
    if (shows_axis && is_seen)
      views.push_back(plan(targetAtEnd(along_axis, camera, table.distance())));
  }
  return views;
}

}  // namespace omnitag
