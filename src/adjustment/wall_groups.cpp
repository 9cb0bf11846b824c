#include "adjustment/wall_groups.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/format.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

bool isOnSameWall(const Marker& a, const Marker& b) {
  const double least_cosine = std::cos(radians(15.0));
  constexpr double kDepth = 0.5;  // m
  return a.normal().dot(b.normal()) > least_cosine &&
         std::abs(a.normal().dot(b.center() - a.center())) < kDepth;
}

Eigen::Vector3d middleOf(const std::vector<Marker>& markers) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Marker& marker : markers) sum += marker.center();
  return sum / static_cast<double>(markers.size());
}

}  // namespace

std::vector<std::vector<std::size_t>> groupedByWall(const std::vector<Marker>& markers) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      return isOnSameWall(markers[group.front()], markers[i]);
    });
    if (same == groups.end()) {
      groups.push_back({i});
    } else {
      same->push_back(i);
    }
  }
  return groups;
}

std::string placeOf(const std::vector<Marker>& markers) {
  const double along_axis = std::cos(radians(10.0));
  const Eigen::Vector3d middle = middleOf(markers);
  const Eigen::Vector3d normal = markers.front().normal();
  if (markers.size() == 1) return format("at (%.1f, %.1f)", middle.x(), middle.y());
  if (normal.z() > along_axis) return "on the floor";
  if (normal.z() < -along_axis) return "under the ceiling";
  if (std::abs(normal.x()) > along_axis) return format("on the wall at x = %.1f m", middle.x());
  if (std::abs(normal.y()) > along_axis) return format("on the wall at y = %.1f m", middle.y());
  return format("on the wall around (%.1f, %.1f)", middle.x(), middle.y());
}

}  // namespace omnitag
