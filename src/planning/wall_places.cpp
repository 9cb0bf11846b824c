#include "planning/wall_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/bounds.h"
#include "common/symmetric_matrix.h"

namespace omnitag {
namespace {

/// An edge between a free and an occupied cell.
struct Border {
  Eigen::Vector2d middle;
  /// Unit vector to the free one.
  Eigen::Vector2d outward;
};

/// In the order of x.
std::vector<Border> bordersOf(const OccupancyGrid& grid) {
  const std::array<Eigen::Vector2i, 4> neighbours{Eigen::Vector2i(1, 0), Eigen::Vector2i(-1, 0),
                                                  Eigen::Vector2i(0, 1), Eigen::Vector2i(0, -1)};
  std::vector<Border> borders;
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      if (grid.at(column, row) != Cell::kFree) continue;
      const Eigen::Vector2d middle = grid.middleOf(column, row);
      for (const Eigen::Vector2i& to : neighbours) {
        if (grid.at(column + to.x(), row + to.y()) != Cell::kOccupied) continue;
        const Eigen::Vector2d other = grid.middleOf(column + to.x(), row + to.y());
        borders.push_back({0.5 * (middle + other), (middle - other).normalized()});
      }
    }
  }
  std::sort(borders.begin(), borders.end(),
            [](const Border& a, const Border& b) { return a.middle.x() < b.middle.x(); });
  return borders;
}

/// A piece of wall as a line.
struct Line {
  Eigen::Vector2d middle;
  /// Out of the wall.
  Eigen::Vector2d normal;
  /// m, of the borders: off the line, and along it from the one in question.
  Bounds across;
  Bounds along;
  std::size_t borders = 0;

  bool isFlat(double roughness) const {
    return across.high <= roughness && across.low >= -roughness;
  }
};

Line lineThrough(const std::vector<Border>& borders, const Eigen::Vector2d& from) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d outward = Eigen::Vector2d::Zero();
  for (const Border& border : borders) {
    mean += border.middle / static_cast<double>(borders.size());
    outward += border.outward;
  }
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Border& border : borders) {
    spread += (border.middle - mean) * (border.middle - mean).transpose();
  }
  const Eigen::Vector2d axis = eigenPairs(spread).vectors.col(0);
  Line line;
  line.middle = mean;
  line.normal = axis.dot(outward) >= 0.0 ? axis : -axis;
  line.borders = borders.size();
  const Eigen::Vector2d along(-line.normal.y(), line.normal.x());
  for (const Border& border : borders) {
    line.across.include(line.normal.dot(border.middle - mean));
    line.along.include(along.dot(border.middle - from));
  }
  return line;
}

/// The wall within `reach` metres of a border. First without the other side of a thin wall, then
/// without what faces elsewhere, such as the walls beyond a corner.
Line lineNear(const Border& border, const std::vector<Border>& borders, double reach) {
  const auto facing = [&](const Eigen::Vector2d& direction, double least) {
    std::vector<Border> near;
    const double east = border.middle.x() + reach;
    auto other = std::lower_bound(borders.begin(), borders.end(), border.middle.x() - reach,
                                  [](const Border& each, double x) { return each.middle.x() < x; });
    for (; other != borders.end() && other->middle.x() <= east; ++other) {
      const bool is_near = (other->middle - border.middle).squaredNorm() <= reach * reach;
      if (is_near && other->outward.dot(direction) >= least) near.push_back(*other);
    }
    return near;
  };
  constexpr double kNotOpposite = -0.5;
  constexpr double kAlike = 0.5;
  const Line rough = lineThrough(facing(border.outward, kNotOpposite), border.middle);
  const std::vector<Border> alike = facing(rough.normal, kAlike);
  return alike.empty() ? rough : lineThrough(alike, border.middle);
}

/// Where a marker hangs at a border, if the wall is flat and wide enough there.
std::optional<WallPlace> placeAt(const Border& border, const std::vector<Border>& borders,
                                 double width, double resolution) {
  constexpr double kLong = 1.0;    // m
  constexpr double kWhole = 0.85;  // with gaps there are fewer borders
  const Line wall = lineNear(border, borders, 0.5 * width + resolution);
  const double half = 0.5 * width - 0.5 * resolution;
  const bool is_wide = wall.along.low <= -half && wall.along.high >= half;
  const bool is_whole = static_cast<double>(wall.borders) * resolution >= kWhole * width;
  if (!wall.isFlat(resolution) || !is_wide || !is_whole) return std::nullopt;
  // A longer piece shows the direction better, if it is as flat.
  const Line longer = lineNear(border, borders, std::max(kLong, width));
  const Line& line = longer.isFlat(resolution) ? longer : wall;
  const Eigen::Vector2d on_wall =
      border.middle + line.normal * line.normal.dot(line.middle - border.middle);
  return WallPlace{on_wall, std::atan2(line.normal.y(), line.normal.x())};
}

/// Whether the floor before the wall is free, all along the marker and some way out.
bool isFreeBefore(const WallPlace& place, const OccupancyGrid& grid, double width) {
  constexpr double kOut = 0.5;  // m
  constexpr double kCells = 1.5;
  const Eigen::Vector2d normal(std::cos(place.yaw), std::sin(place.yaw));
  const Eigen::Vector2d half =
      0.5 * (width - grid.resolution()) * Eigen::Vector2d(-normal.y(), normal.x());
  const Eigen::Vector2d before = place.position + kCells * grid.resolution() * normal;
  return grid.isClear(before - half, before + half) &&
         grid.isClear(before, place.position + kOut * normal);
}

/// Whether one of the places is near, on the same side of a wall. `normal`: out of the wall.
bool isTaken(const Eigen::Vector2d& position, const Eigen::Vector2d& normal,
             const std::vector<WallPlace>& places, double spacing) {
  constexpr double kSameSide = 0.5;
  return std::any_of(places.begin(), places.end(), [&](const WallPlace& place) {
    const Eigen::Vector2d other(std::cos(place.yaw), std::sin(place.yaw));
    return (place.position - position).norm() < spacing && other.dot(normal) > kSameSide;
  });
}

}  // namespace

std::vector<WallPlace> wallPlaces(const OccupancyGrid& grid, double width, double spacing) {
  const std::vector<Border> borders = bordersOf(grid);
  std::vector<WallPlace> places;
  for (const Border& border : borders) {
    if (isTaken(border.middle, border.outward, places, spacing)) continue;
    const auto place = placeAt(border, borders, width, grid.resolution());
    if (!place || !isFreeBefore(*place, grid, width)) continue;
    const Eigen::Vector2d normal(std::cos(place->yaw), std::sin(place->yaw));
    if (!isTaken(place->position, normal, places, spacing)) places.push_back(*place);
  }
  return places;
}

}  // namespace omnitag
