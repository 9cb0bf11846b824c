#include "omnitag/localization/marker_patch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace omnitag {

MarkerPatch::MarkerPatch(const Marker& marker, const TagPattern& pattern,
                         const MountedCamera& camera, const Pose2& map_from_base, double blur,
                         const Choice& choice)
    : marker_(marker),
      pattern_(pattern),
      camera_(camera),
      metres_per_module_(marker.size / pattern.widthBetweenCorners()),
      // A Gaussian blur and a box have the same variance where the box is sqrt(12) deviations wide.
      stretch_(std::sqrt(1.0 + 12.0 * blur * blur)) {
  chooseLinesOfSight(map_from_base, choice);
}

MarkerPatch::Box MarkerPatch::boundingBox(const Pose2& map_from_base) const {
  const ImageSize& size = camera_.model().imageSize();
  const double cell_width = static_cast<double>(pattern_.width()) / kCells;
  Eigen::Vector2d low(size.width, size.height);
  Eigen::Vector2d high(-1.0, -1.0);
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells; ++j) {
      // Edges image as curves, which reach farther than their ends.
      const bool is_on_outline = i % kCells == 0 || j % kCells == 0;
      if (!is_on_outline) continue;
      const auto pixel =
          camera_.pixelFromMap(map_from_base, inMap(cell_width * Eigen::Vector2d(i, j)));
      if (!pixel) continue;
      low = low.cwiseMin(*pixel);
      high = high.cwiseMax(*pixel);
    }
  }
  return {std::max(0, static_cast<int>(low.x()) - 1), std::max(0, static_cast<int>(low.y()) - 1),
          std::min(size.width - 1, static_cast<int>(high.x()) + 2),
          std::min(size.height - 1, static_cast<int>(high.y()) + 2)};
}

void MarkerPatch::chooseLinesOfSight(const Pose2& map_from_base, const Choice& choice) {
  const Cells cells = cellsAt(map_from_base);
  const Eigen::Isometry3d marker_from_base =
      marker_.map_from_marker.inverse() * map_from_base.toIsometry();
  const auto positionAt = [&](int column, int row) -> std::optional<Eigen::Vector2d> {
    const std::optional<Ray> ray = camera_.tabulatedRayInBase({column, row});
    return ray ? meet(*ray, marker_from_base) : std::nullopt;
  };
  std::vector<Pixel> at_edges;
  std::vector<Pixel> on_even_ground;
  const auto consider = [&](int column, int row, const Eigen::Vector2d& position) {
    const Cell& cell = cellOf(cells, position);
    if (!cell.is_visible) return;
    // The pose may still move by a pixel or two.
    constexpr double kReach = 2.0;
    const Eigen::Vector2d reach = kReach * cell.by_pixel.cwiseAbs().rowwise().sum();
    if ((position + reach).minCoeff() < 0.0 ||
        (position - reach).maxCoeff() > static_cast<double>(pattern_.width())) {
      return;
    }
    const bool is_even = pattern_.isEven(position - reach, position + reach);
    (is_even ? on_even_ground : at_edges).push_back({column, row});
  };

  // Roughly, positions follow from those of nodes around them.
  const int node_step = 8 * choice.step;
  const Box box = boundingBox(map_from_base);
  for (int top = box.top; top <= box.bottom; top += node_step) {
    auto upper_left = positionAt(box.left, top);
    auto lower_left = positionAt(box.left, top + node_step);
    for (int left = box.left; left <= box.right; left += node_step) {
      const auto upper_right = positionAt(left + node_step, top);
      const auto lower_right = positionAt(left + node_step, top + node_step);
      const bool has_nodes = upper_left && lower_left && upper_right && lower_right;
      for (int row = top; row < std::min(top + node_step, box.bottom + 1); row += choice.step) {
        for (int column = left; column < std::min(left + node_step, box.right + 1);
             column += choice.step) {
          if (has_nodes) {
            const double a = static_cast<double>(column - left) / node_step;
            const double b = static_cast<double>(row - top) / node_step;
            consider(column, row,
                     (1.0 - b) * ((1.0 - a) * *upper_left + a * *upper_right) +
                         b * ((1.0 - a) * *lower_left + a * *lower_right));
          } else if (const auto position = positionAt(column, row)) {
            consider(column, row, *position);
          }
        }
      }
      upper_left = upper_right;
      lower_left = lower_right;
    }
  }
  keep(at_edges, choice.max_at_edges);
  keep(on_even_ground, choice.max_on_even_ground);
}

void MarkerPatch::keep(const std::vector<Pixel>& pixels, std::size_t at_most) {
  if (at_most == 0) return;
  const std::size_t every = (pixels.size() + at_most - 1) / at_most;
  for (std::size_t i = 0; i < pixels.size(); i += std::max<std::size_t>(1, every)) {
    const auto ray = camera_.tabulatedRayInBase({pixels[i].column, pixels[i].row});
    if (ray) lines_of_sight_.push_back({pixels[i], *ray});
  }
}

std::vector<Footprint> MarkerPatch::footprints(const Pose2& map_from_base) const {
  const Cells cells = cellsAt(map_from_base);
  const Eigen::Isometry3d marker_from_base =
      marker_.map_from_marker.inverse() * map_from_base.toIsometry();
  const double width = pattern_.width();
  std::vector<Footprint> footprints;
  footprints.reserve(lines_of_sight_.size());
  for (const LineOfSight& line : lines_of_sight_) {
    const auto position = meet(line.in_base, marker_from_base);
    if (!position) continue;
    const Cell& cell = cellOf(cells, *position);
    if (!cell.is_visible) continue;
    const Eigen::Matrix2d sides = stretch_ * cell.by_pixel;
    const Eigen::Vector2d reach = 0.5 * sides.cwiseAbs().rowwise().sum();
    if ((*position - reach).minCoeff() < 0.0 || (*position + reach).maxCoeff() > width) continue;
    footprints.push_back(
        {line.pixel.column, line.pixel.row, *position, sides, cell.by_pixel, cell.by_pose});
  }
  return footprints;
}

std::vector<MarkerPixel> MarkerPatch::pixels(const cv::Mat& panorama,
                                             const Pose2& map_from_base) const {
  const double width = pattern_.width();
  std::vector<MarkerPixel> pixels;
  for (const Footprint& footprint : footprints(map_from_base)) {
    const TagPattern::White white =
        pattern_.averageOver(footprint.position, footprint.sides.col(0), footprint.sides.col(1));
    MarkerPixel pixel;
    pixel.column = footprint.column;
    pixel.row = footprint.row;
    pixel.grey = panorama.at<std::uint8_t>(footprint.row, footprint.column);
    pixel.white = white.share;
    pixel.gradient = (white.by_position.transpose() * footprint.by_pixel).norm();
    pixel.position = footprint.position / width - Eigen::Vector2d(0.5, 0.5);
    pixel.white_by_pose = white.by_position.transpose() * footprint.by_pose;
    pixels.push_back(pixel);
  }
  return pixels;
}

MarkerPatch::Cells MarkerPatch::cellsAt(const Pose2& map_from_base) const {
  const double cell_width = static_cast<double>(pattern_.width()) / kCells;
  std::vector<std::optional<Eigen::Vector2d>> nodes;
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells; ++j) {
      nodes.push_back(
          camera_.pixelFromMap(map_from_base, inMap(cell_width * Eigen::Vector2d(i, j))));
    }
  }
  const auto nodeAt = [&nodes](int i, int j) -> const std::optional<Eigen::Vector2d>& {
    constexpr std::size_t kNodes = kCells + 1;
    return nodes[static_cast<std::size_t>(i) * kNodes + static_cast<std::size_t>(j)];
  };
  Cells cells;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const auto& upper_left = nodeAt(i, j);
      const auto& upper_right = nodeAt(i + 1, j);
      const auto& lower_left = nodeAt(i, j + 1);
      const auto& lower_right = nodeAt(i + 1, j + 1);
      if (!upper_left || !upper_right || !lower_left || !lower_right) continue;
      Eigen::Matrix2d pixel_by_position;
      pixel_by_position << *upper_right + *lower_right - *upper_left - *lower_left,
          *lower_left + *lower_right - *upper_left - *upper_right;
      pixel_by_position /= 2.0 * cell_width;
      if (std::abs(pixel_by_position.determinant()) < 1e-6) continue;
      const Eigen::Vector2d middle = cell_width * Eigen::Vector2d(i + 0.5, j + 0.5);
      Eigen::Matrix<double, 2, 3> pixel_by_pose;
      if (!camera_.pixelFromMap(map_from_base, inMap(middle), &pixel_by_pose)) continue;
      Cell& cell = cells[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
      cell.is_visible = true;
      cell.by_pixel = pixel_by_position.inverse();
      cell.by_pose = -cell.by_pixel * pixel_by_pose;
    }
  }
  return cells;
}

const MarkerPatch::Cell& MarkerPatch::cellOf(const Cells& cells,
                                             const Eigen::Vector2d& position) const {
  const auto indexAlong = [this](double coordinate) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>(coordinate * kCells / pattern_.width()), 0, kCells - 1));
  };
  return cells[indexAlong(position.x())][indexAlong(position.y())];
}

Eigen::Vector3d MarkerPatch::inMap(const Eigen::Vector2d& position) const {
  const double half = 0.5 * pattern_.width();
  return marker_.map_from_marker *
         (metres_per_module_ * Eigen::Vector3d(position.x() - half, half - position.y(), 0.0));
}

std::optional<Eigen::Vector2d> MarkerPatch::meet(const Ray& in_base,
                                                 const Eigen::Isometry3d& marker_from_base) const {
  const Eigen::Vector3d origin = marker_from_base * in_base.origin;
  const Eigen::Vector3d direction = marker_from_base.linear() * in_base.direction;
  if (origin.z() <= 0.0 || direction.z() >= 0.0) return std::nullopt;
  const double range = -origin.z() / direction.z();
  const double half = 0.5 * pattern_.width();
  return Eigen::Vector2d(half + (origin.x() + range * direction.x()) / metres_per_module_,
                         half - (origin.y() + range * direction.y()) / metres_per_module_);
}

}  // namespace omnitag
