#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// An entry of the map as it was measured in the panoramic image, in its pixels.
struct MarkerObservation {
  std::size_t map_entry = 0;
  Corners<Eigen::Vector2d> corners;
  Eigen::Vector2d center;
  /// Pixels, standard deviation of each corner's place along each axis relative to the marker's
  /// middle, beside a corner's noise: where a marker is only found as a whole, its shape is that of
  /// the prediction.
  double shape_deviation = 0.0;
  /// As MarkerDetection has them.
  int hamming = -1;
  double margin = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace omnitag
