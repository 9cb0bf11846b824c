#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A marker that was decoded, in pixels of the panorama.
struct MarkerReading {
  std::string family;
  int id = 0;
  /// Number of bits that were corrected.
  int hamming = 0;
  Corners<Eigen::Vector2d> corners;
  Eigen::Vector2d center;
  /// Index of the view in which it was decoded.
  std::size_t view = 0;
  /// Grey levels, mean distance of its modules from the threshold between black and white.
  double margin = 0.0;
};

}  // namespace omnitag
