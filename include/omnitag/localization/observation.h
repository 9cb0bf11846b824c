#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// An entry of the map as it was measured in the panoramic image, in its pixels.
struct MarkerObservation {
  std::size_t map_entry = 0;
  Corners<Eigen::Vector2d> corners;
  Eigen::Vector2d center;
};

}  // namespace omnitag
