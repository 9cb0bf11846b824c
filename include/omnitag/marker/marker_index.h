#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Heights (m), from least to most; none at first.
struct HeightRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  bool isEmpty() const { return !(low <= high); }
  void include(double height);
};

/// Where the markers of a map, with their white borders, are above its origin.
struct MarkerHeights {
  HeightRange upright;
  /// Of those on the floor or under the ceiling, which can be right below or above a camera, where
  /// upright ones cannot be read.
  HeightRange lying;
};

MarkerHeights heightsOf(const MarkerMap& map);

/// What is often asked of a map, told without a look at each of its thousands of markers.
class MarkerIndex {
 public:
  explicit MarkerIndex(const MarkerMap& map);

  /// Entries whose centres are no farther than `range` (m) from a point of the map, in their order.
  std::vector<std::size_t> within(double range, const Eigen::Vector3d& point) const;

  /// As heightsOf() tells them.
  const MarkerHeights& heights() const { return heights_; }

 private:
  /// Side by side, unlike in the map, where there is much between them.
  std::vector<Eigen::Vector3d> centers_;
  MarkerHeights heights_;
};

}  // namespace omnitag
