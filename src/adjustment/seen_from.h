#pragma once

#include <Eigen/Core>
#include <vector>

#include "adjustment/marker_estimate.h"

namespace omnitag {

/// From where a marker was seen.
struct SeenFrom {
  /// m, from its centre to the nearest place of the camera; 0 if it was not seen.
  double nearest = 0.0;
  /// rad, the largest angle between the directions from which it was seen.
  double parallax = 0.0;
};

/// `center`: the marker's, in the map. The robot's poses must be known in all sightings.
SeenFrom seenFrom(const Eigen::Vector3d& center, const std::vector<MarkerSighting>& sightings);

}  // namespace omnitag
