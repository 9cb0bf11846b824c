#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning/occupancy_grid.h"

namespace omnitag {

/// Where a marker could hang on a wall.
struct WallPlace {
  /// m, in the map, on the border between free and occupied cells.
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  /// rad, heading of the normal out of the wall.
  double yaw = 0.0;
};

/// Places along the walls, at least `spacing` metres apart on each side of a wall, where it is flat
/// over `width` metres, to a cell, and the floor in front of it is free.
std::vector<WallPlace> wallPlaces(const OccupancyGrid& grid, double width, double spacing);

}  // namespace omnitag
