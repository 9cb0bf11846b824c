#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/bounds.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Heights of a map's markers above its origin, each with a strip of the white border that makes
/// it readable.
struct MarkerHeights {
  Bounds upright;
  /// For markers on the floor or under the ceiling, which can be right below or above a camera,
  /// where upright ones cannot be read.
  Bounds lying;
  /// m, the edge of the smallest upright marker; 0 if there is none.
  double smallest_upright = 0.0;
};

MarkerHeights heightsOf(const MarkerMap& map);

/// Answers frequent queries of a map without visiting each of its thousands of markers.
class MarkerIndex {
 public:
  explicit MarkerIndex(const MarkerMap& map);

  /// Entries whose centres are at most `range` (m) away from a point of the map, in the
  /// map's order.
  std::vector<std::size_t> within(double range, const Eigen::Vector3d& point) const;

  /// The same as heightsOf().
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
