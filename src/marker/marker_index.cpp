#include "omnitag/marker/marker_index.h"

namespace omnitag {

MarkerIndex::MarkerIndex(const MarkerMap& map) {
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
