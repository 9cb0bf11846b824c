#include "planning/sight.h"

#include <algorithm>
#include <array>

#include "marker/marker_prediction.h"
#include "planning/family_limits.h"

namespace omnitag {
namespace {

/// `normal`: the horizontal part of the marker's.
bool isPointInSight(const OccupancyGrid& grid, const Eigen::Vector2d& viewpoint,
                    const Eigen::Vector2d& point, const Eigen::Vector2d& normal,
                    double wall_depth) {
  // A line of sight that grazes a wall stays near it for long, but cells farther along it belong to
  // another wall, as beyond the corner of a room.
  constexpr double kLeastCosine = 0.35;
  // A marker on the floor or under the ceiling faces no horizontal direction.
  constexpr double kUpright = 0.1;
  const Eigen::Vector2d back = viewpoint - point;
  const double distance = back.norm();
  if (distance <= wall_depth) return true;
  const double cosine = normal.norm() > kUpright ? normal.normalized().dot(back) / distance : 1.0;
  const double gap = wall_depth / std::max(cosine, kLeastCosine);
  return gap >= distance || grid.isClear(viewpoint, point + gap / distance * back);
}

}  // namespace

bool isInSight(const OccupancyGrid& grid, const Eigen::Vector3d& viewpoint, const Marker& marker,
               double wall_depth) {
  if (marker.normal().dot(viewpoint - marker.center()) <= 0.0) return false;
  constexpr double kCells = 2.0;
  const double depth = std::max(wall_depth, kCells * grid.resolution());
  const Eigen::Matrix3d axes = marker.map_from_marker.linear();
  const Eigen::Vector2d right = 0.5 * marker.size * axes.col(0).head<2>();
  const Eigen::Vector2d up = 0.5 * marker.size * axes.col(1).head<2>();
  const Eigen::Vector2d reach = right.norm() > up.norm() ? right : up;
  const Eigen::Vector2d center = marker.center().head<2>();
  const std::array<Eigen::Vector2d, 3> points{center, center + reach, center - reach};
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector2d& point) {
    return isPointInSight(grid, viewpoint.head<2>(), point, marker.normal().head<2>(), depth);
  });
}

bool isRecognized(const PlanningScene& scene, const MarkerMap& map, std::size_t entry,
                  const PatternEdges& edges, const Pose& map_from_base) {
  const Marker& marker = map.markers[entry];
  const VisibilityConfig& visibility = scene.config.localizer.visibility;
  const Eigen::Vector3d viewpoint = scene.camera.mapFromCamera(map_from_base).translation();
  if ((viewpoint - marker.center()).norm() > visibility.max_range) return false;
  if (!isInSight(scene.grid, viewpoint, marker, scene.config.wall_depth)) return false;
  const auto predicted = predictMarker(map, entry, scene.camera, {map_from_base}, visibility);
  const double features = edges.modules / edges.feature_width;
  const double least = features * smallestModulesOf(marker.family).recognized;
  return predicted && longestEdge(predicted->corners) >= least;
}

}  // namespace omnitag
