#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "omnitag/common/bounds.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Where the markers of a map, each with a strip of the white around it that makes it readable, are
/// above its origin.
struct MarkerHeights {
  Bounds upright;
  /// Of those on the floor or under the ceiling, which can be right below or above a camera, where
  /// upright ones cannot be read.
  Bounds lying;
  /// m, the edge of the smallest upright one; 0 where there are none.
  double smallest_upright = 0.0;
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
  struct Place {
    Eigen::Vector3d center;
    std::size_t entry;
  };

  /// Sorted along the axis of the map along which they spread the most.
  std::vector<Place> places_;
  int axis_ = 0;
  MarkerHeights heights_;
};

}  // namespace omnitag
