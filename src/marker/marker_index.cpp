#include "omnitag/marker/marker_index.h"

#include <cmath>

#include "omnitag/common/angle.h"

namespace omnitag {

MarkerHeights heightsOf(const MarkerMap& map) {
  constexpr double kWithBorder = 1.2;
  const double lying = std::sin(radians(45.0));
  MarkerHeights heights;
  for (const Marker& marker : map.markers) {
    const double center = marker.center().z();
    Bounds& range = std::abs(marker.normal().z()) > lying ? heights.lying : heights.upright;
    for (const Eigen::Vector3d& corner : marker.corners()) {
      range.include(center + kWithBorder * (corner.z() - center));
    }
  }
  return heights;
}

MarkerIndex::MarkerIndex(const MarkerMap& map) : heights_(heightsOf(map)) {
  centers_.reserve(map.markers.size());
  for (const Marker& marker : map.markers) centers_.push_back(marker.center());
}

std::vector<std::size_t> MarkerIndex::within(double range, const Eigen::Vector3d& point) const {
  std::vector<std::size_t> entries;
  for (std::size_t i = 0; i < centers_.size(); ++i) {
    if ((centers_[i] - point).squaredNorm() <= range * range) entries.push_back(i);
  }
  return entries;
}

}  // namespace omnitag
