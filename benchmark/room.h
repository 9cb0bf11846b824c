#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <random>
#include <set>
#include <vector>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A vertical wall without thickness, from the floor to above everything.
struct Wall {
  Eigen::Vector2d from;
  Eigen::Vector2d to;

  double length() const { return (to - from).norm(); }
  Eigen::Vector2d along() const { return (to - from).normalized(); }
  double distanceTo(const Eigen::Vector2d& point) const;
};

/// Whether a wall stands between two points.
bool isHidden(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const std::vector<Wall>& walls);

/// A room of random size, sometimes divided by a wall with a gap, with markers on its walls.
struct Room {
  /// m, from the origin of the map, its corner.
  Eigen::Vector2d size = Eigen::Vector2d::Zero();
  /// The four around it, and what stands in it.
  std::vector<Wall> walls;
  /// Middle of the gap, where there is one, and the unit vector through it.
  bool is_divided = false;
  Eigen::Vector2d gap = Eigen::Vector2d::Zero();
  Eigen::Vector2d through_gap = Eigen::Vector2d::Zero();
  MarkerMap markers;

  /// Whether a point of the room is so far (m) from every wall.
  bool isFree(const Eigen::Vector2d& point, double clearance) const;
};

Room randomRoom(std::mt19937* generator);

/// Neighbouring markers that moved as one.
struct MovedGroup {
  /// Entries of the room's markers.
  std::set<std::size_t> entries;
  double shift = 0.0;      // m, horizontal
  double direction = 0.0;  // rad, of the shift in the map
  double turn = 0.0;       // rad, about the vertical through their middle
};

/// A marker and those nearest to it; at least two others stay. Turned only on request.
MovedGroup randomGroup(const MarkerMap& markers, bool is_turned, std::mt19937* generator);

/// The map that has the group so far from where it hangs.
MarkerMap displaced(const MarkerMap& markers, const MovedGroup& group);

}  // namespace omnitag
