#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A map entry as measured in the panoramic image, in its pixels.
struct MarkerObservation {
  std::size_t map_entry = 0;
  Corners<Eigen::Vector2d> corners;
  Eigen::Vector2d center;
  /// Pixels: standard deviation of each corner along each axis relative to the marker's middle, in
  /// addition to the corner's noise. A marker that is only found as a whole takes its shape from
  /// the prediction.
  double shape_deviation = 0.0;
  /// As in MarkerDetection.
  int hamming = -1;
  double margin = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace omnitag
