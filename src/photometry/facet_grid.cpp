#include "photometry/facet_grid.h"

#include <Eigen/LU>
#include <cmath>
#include <optional>

#include "common/grid_index.h"
#include "photometry/drawing_plane.h"
#include "photometry/node_grid.h"

namespace omnitag {
namespace {

/// The corners of this many facets along either side, each projected (pixels).
NodeGrid projectedNodes(const Marker& marker, const TagPattern& pattern,
                        const MountedCamera& camera, const Pose& map_from_base, int facets) {
  const double metres_per_module = marker.size / pattern.widthBetweenCorners();
  const double half = 0.5 * pattern.width();
  const double width = static_cast<double>(pattern.width()) / facets;
  const Eigen::Isometry3d isometry = map_from_base.toIsometry();
  NodeGrid nodes;
  nodes.reserve(gridIndex(0, facets + 1, facets + 1));
  for (int row = 0; row <= facets; ++row) {
    for (int column = 0; column <= facets; ++column) {
      const Eigen::Vector3d in_marker =
          metres_per_module * Eigen::Vector3d(width * column - half, half - width * row, 0.0);
      nodes.push_back(camera.pixelFromMap(isometry, marker.map_from_marker * in_marker));
    }
  }
  return nodes;
}

NodeGrid nodesOf(const Marker& marker, const TagPattern& pattern, const MountedCamera& camera,
                 const Pose& map_from_base, int facets) {
  // A drawing images so smoothly that a few nodes determine all others.
  if (facets > kProjectedFacets) {
    auto nodes = interpolated(
        projectedNodes(marker, pattern, camera, map_from_base, kProjectedFacets), facets);
    if (nodes) return *nodes;
  }
  return projectedNodes(marker, pattern, camera, map_from_base, facets);
}

PixelBox boxAround(const NodeGrid& nodes, const ImageSize& size) {
  Eigen::Vector2d low(size.width, size.height);
  Eigen::Vector2d high(-1.0, -1.0);
  for (const auto& node : nodes) {
    if (!node) continue;
    low = low.cwiseMin(*node);
    high = high.cwiseMax(*node);
  }
  return {std::max(0, static_cast<int>(low.x()) - 1), std::max(0, static_cast<int>(low.y()) - 1),
          std::min(size.width - 1, static_cast<int>(high.x()) + 2),
          std::min(size.height - 1, static_cast<int>(high.y()) + 2)};
}

}  // namespace

FacetGrid::FacetGrid(const Marker& marker, const TagPattern& pattern, const MountedCamera& camera,
                     const Pose& map_from_base, int facets_along)
    : facets_along_(facets_along),
      facets_per_module_(static_cast<double>(facets_along) / pattern.width()) {
  const NodeGrid nodes = nodesOf(marker, pattern, camera, map_from_base, facets_along);
  box_ = boxAround(nodes, camera.model().imageSize());
  const DrawingPlane plane(marker, pattern, map_from_base);
  const PoseMatrix along_base = changeByMotion(map_from_base.toIsometry().linear());
  const PoseVector exposed_motion = camera.exposedMotion();
  const auto nodeAt = [&](int column, int row) -> const std::optional<Eigen::Vector2d>& {
    return nodes[gridIndex(column, row, facets_along + 1)];
  };
  facets_.reserve(gridIndex(0, facets_along, facets_along));
  for (int row = 0; row < facets_along; ++row) {
    for (int column = 0; column < facets_along; ++column) {
      Facet& facet = facets_.emplace_back();
      facet.middle = (Eigen::Vector2d(column, row).array() + 0.5) / facets_along - 0.5;
      const auto& upper_left = nodeAt(column, row);
      const auto& upper_right = nodeAt(column + 1, row);
      const auto& lower_left = nodeAt(column, row + 1);
      const auto& lower_right = nodeAt(column + 1, row + 1);
      if (!upper_left || !upper_right || !lower_left || !lower_right) continue;
      Eigen::Matrix2d pixel_by_position;
      pixel_by_position << *upper_right + *lower_right - *upper_left - *lower_left,
          *lower_left + *lower_right - *upper_left - *upper_right;
      pixel_by_position *= 0.5 * facets_per_module_;
      if (std::abs(pixel_by_position.determinant()) < 1e-6) continue;
      const Eigen::Vector2d middle =
          0.25 * (*upper_left + *upper_right + *lower_left + *lower_right);
      const auto ray = camera.tabulatedRayInBase(middle);
      if (!ray || !plane.meet(*ray)) continue;
      facet.is_visible = true;
      facet.by_pixel = pixel_by_position.inverse();
      const Eigen::Matrix<double, 2, 6> by_pose = plane.derivative(*ray);
      const Eigen::Matrix<double, 2, 6> by_base = by_pose * along_base;
      // A pixel shows what an ideal camera would show at the place that the error moves it from.
      facet.by_frame << by_pose, -facet.by_pixel * camera.model().displacementByError(middle),
          camera.byVelocities(middle, by_base);
      facet.window = TagPattern::Window(facet.by_pixel.col(0), facet.by_pixel.col(1),
                                        camera.lensVariance(middle), by_base * exposed_motion);
    }
  }
}

double FacetGrid::area() const {
  const double facet_area = 1.0 / (facets_per_module_ * facets_per_module_);  // modules squared
  double pixels = 0.0;
  for (const Facet& facet : facets_) {
    if (facet.is_visible) pixels += facet_area / std::abs(facet.by_pixel.determinant());
  }
  return pixels;
}

}  // namespace omnitag
