#include "marker/marker_index.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "omnitag/common/angle.h"

namespace omnitag {

MarkerHeights heightsOf(const MarkerMap& map) {
  constexpr double kWithSomeWhite = 1.2;
  const double lying = std::sin(radians(45.0));
  MarkerHeights heights;
  for (const Marker& marker : map.markers) {
    const double center = marker.center().z();
    const bool is_lying = std::abs(marker.normal().z()) > lying;
    if (!is_lying && (heights.upright.isEmpty() || marker.size < heights.smallest_upright)) {
      heights.smallest_upright = marker.size;
    }
    Bounds& range = is_lying ? heights.lying : heights.upright;
    for (const Eigen::Vector3d& corner : marker.corners()) {
      range.include(center + kWithSomeWhite * (corner.z() - center));
    }
  }
  return heights;
}

MarkerIndex::MarkerIndex(const MarkerMap& map) : heights_(heightsOf(map)) {
  Eigen::AlignedBox3d extent;
  places_.reserve(map.markers.size());
  for (const Marker& marker : map.markers) {
    places_.push_back({marker.center(), places_.size()});
    extent.extend(marker.center());
  }
  if (!extent.isEmpty()) extent.sizes().maxCoeff(&axis_);
  std::sort(places_.begin(), places_.end(),
            [this](const Place& a, const Place& b) { return a.center[axis_] < b.center[axis_]; });
}

std::vector<std::size_t> MarkerIndex::within(double range, const Eigen::Vector3d& point) const {
  std::vector<std::size_t> entries;
  const auto first = std::lower_bound(
      places_.begin(), places_.end(), point[axis_] - range,
      [this](const Place& place, double position) { return place.center[axis_] < position; });
  for (auto it = first; it != places_.end() && it->center[axis_] <= point[axis_] + range; ++it) {
    if ((it->center - point).squaredNorm() <= range * range) entries.push_back(it->entry);
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

}  // namespace omnitag
