#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Tells which markers of a map are near a point: of thousands, in microseconds.
class MarkerIndex {
 public:
  explicit MarkerIndex(const MarkerMap& map);

  /// Entries whose centres are no farther than `range` (m) from a point of the map, in their order.
  std::vector<std::size_t> within(double range, const Eigen::Vector3d& point) const;

 private:
  /// Side by side, unlike in the map, where there is much between them.
  std::vector<Eigen::Vector3d> centers_;
};

}  // namespace omnitag
