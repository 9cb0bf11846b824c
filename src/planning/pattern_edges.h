#pragma once

#include <vector>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The edges between the modules of a marker's pattern.
struct PatternEdges {
  /// Modules between the corners that the library reports, and modules over which the pattern
  /// hardly varies: 1 for codes.
  int modules = 1;
  double feature_width = 1.0;
  /// Modules, total length of the edges along the marker's x axis, and along its y axis, each times
  /// the square of its contrast: that between black and white is 1.
  double along_x = 0.0;
  double along_y = 0.0;
};

/// Throws InputError for an unknown family, or an id that the family does not have.
PatternEdges edgesOf(const Marker& marker);

/// One for each marker of the map.
std::vector<PatternEdges> edgesOf(const MarkerMap& map);

}  // namespace omnitag
