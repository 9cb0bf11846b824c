#include "adjustment/seen_from.h"

#include <algorithm>
#include <limits>

namespace omnitag {

SeenFrom seenFrom(const Eigen::Vector3d& center, const std::vector<MarkerSighting>& sightings) {
  if (sightings.empty()) return {};
  double nearest = std::numeric_limits<double>::infinity();
  for (const MarkerSighting& sighting : sightings) {
    const Eigen::Vector3d camera = sighting.map_from_base.pose.toIsometry() *
                                   Eigen::Vector3d(sighting.base_from_camera.translation());
    nearest = std::min(nearest, (camera - center).norm());
  }
  return {nearest, parallax(center, sightings)};
}

}  // namespace omnitag
