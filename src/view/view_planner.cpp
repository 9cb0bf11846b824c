#include "view/view_planner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/yaml_reader.h"

namespace omnitag {
namespace {

struct Group {
  ViewTarget target;
  std::vector<std::size_t> members;
};

Group merged(const Group& a, const Group& b) {
  const double offset = normalizeAngle(b.target.azimuth - a.target.azimuth);
  const double low = std::min(-a.target.half_width, offset - b.target.half_width);
  const double high = std::max(a.target.half_width, offset + b.target.half_width);
  Group group;
  group.target.azimuth = normalizeAngle(a.target.azimuth + 0.5 * (low + high));
  group.target.half_width = 0.5 * (high - low);
  group.target.min_radius = std::min(a.target.min_radius, b.target.min_radius);
  group.target.max_radius = std::max(a.target.max_radius, b.target.max_radius);
  group.target.distance = 0.5 * (a.target.distance + b.target.distance);
  group.members = a.members;
  group.members.insert(group.members.end(), b.members.begin(), b.members.end());
  return group;
}

View planFacing(const ViewTarget& target, bool axis_up, const ViewPlannerConfig& config) {
  constexpr double kWidest = radians(60.0);
  const ViewCone& cone = *target.cone;
  View view;
  view.azimuth = std::atan2(cone.direction.y(), cone.direction.x());
  view.elevation = std::atan2(cone.direction.z(), cone.direction.head<2>().norm());
  view.distance = target.distance;
  view.axis_up = axis_up;
  const double width = 2.0 * std::tan(std::min(cone.half_angle, kWidest));
  view.focal_length = std::min(config.oversampling * cone.resolution, config.max_size / width);
  const int pixels = static_cast<int>(std::ceil(width * view.focal_length));
  view.size = {pixels, pixels};
  return view;
}

}  // namespace

ViewPlannerConfig readViewPlannerConfig(const YamlReader& reader) {
  reader.allowOnly({"oversampling", "max_size", "max_merged_half_width"});
  ViewPlannerConfig config;
  reader.read("oversampling", &config.oversampling, {0.25, 8.0});
  reader.read("max_size", &config.max_size, {32, 4096});
  reader.read("max_merged_half_width", &config.max_merged_half_width,
              {0.0, ContourTable::kMaxAzimuthOffset});
  return config;
}

View planView(const ViewTarget& target, const ContourTable& table, double pixels_per_unit,
              bool axis_up, const ViewPlannerConfig& config) {
  if (target.cone) return planFacing(target, axis_up, config);
  View view;
  view.azimuth = target.azimuth;
  view.distance = target.distance;
  view.axis_up = axis_up;

  // The rectangle's height must cover the target's middle as well as its sides, which are
  // farther away.
  const double half_width = std::min(target.half_width, ContourTable::kMaxAzimuthOffset);
  const double side_distance = target.distance / std::cos(half_width);
  // Lines of sight along the axis never reach the rectangle.
  const auto height = [&](double radius, double distance) {
    constexpr double kSteepest = 4.0;
    const double limit = kSteepest * target.distance;
    return std::clamp(table.height(radius, distance), -limit, limit);
  };
  const auto [bottom, top] = std::minmax(
      {height(target.min_radius, target.distance), height(target.max_radius, target.distance),
       height(target.min_radius, side_distance), height(target.max_radius, side_distance)});
  view.middle_height = 0.5 * (bottom + top);

  const double width = 2.0 * std::tan(half_width);
  const double view_height = (top - bottom) / target.distance;
  const double best_resolution = target.max_radius * pixels_per_unit;  // pixels per radian
  view.focal_length = std::min(config.oversampling * best_resolution,
                               config.max_size / std::max(width, view_height));
  view.size = {static_cast<int>(std::ceil(width * view.focal_length)),
               static_cast<int>(std::ceil(view_height * view.focal_length))};
  return view;
}

std::vector<View> planViews(const std::vector<ViewTarget>& targets, const ContourTable& table,
                            double pixels_per_unit, bool axis_up, const ViewPlannerConfig& config) {
  const auto plan = [&](const Group& group) {
    View view = planView(group.target, table, pixels_per_unit, axis_up, config);
    view.targets = group.members;
    return view;
  };
  std::vector<std::pair<Group, View>> planned;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    Group group{targets[i], {i}};
    View view = plan(group);
    // Each merger may make another one worthwhile, so start over after it.
    for (std::size_t k = 0; k < planned.size();) {
      if (group.target.cone || planned[k].first.target.cone) {
        ++k;
        continue;
      }
      Group candidate = merged(planned[k].first, group);
      View candidate_view = plan(candidate);
      if (candidate.target.half_width <= config.max_merged_half_width &&
          candidate_view.size.area() <= view.size.area() + planned[k].second.size.area()) {
        group = std::move(candidate);
        view = std::move(candidate_view);
        planned.erase(planned.begin() + static_cast<std::ptrdiff_t>(k));
        k = 0;
      } else {
        ++k;
      }
    }
    planned.emplace_back(std::move(group), std::move(view));
  }

  std::vector<View> views;
  views.reserve(planned.size());
  for (auto& [group, view] : planned) views.push_back(std::move(view));
  return views;
}

}  // namespace omnitag
