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

void MarkerPatch::chooseLinesOfSight(const Pose2& map_from_base, const Choice& choice) {
  const ImageSize& size = camera_.model().imageSize();
  const double width = pattern_.width();
  Eigen::Vector2d low(size.width, size.height);
  Eigen::Vector2d high(-1.0, -1.0);
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(width, 0.0), Eigen::Vector2d(0.0, width),
        Eigen::Vector2d(width, width)}) {
    const auto pixel = camera_.pixelFromMap(map_from_base, inMap(corner));
    if (!pixel) continue;
    low = low.cwiseMin(*pixel);
    high = high.cwiseMax(*pixel);
  }
  const int left = std::max(0, static_cast<int>(low.x()) - 1);
  const int top = std::max(0, static_cast<int>(low.y()) - 1);
  const int right = std::min(size.width - 1, static_cast<int>(high.x()) + 2);
  const int bottom = std::min(size.height - 1, static_cast<int>(high.y()) + 2);

  const Cells cells = cellsAt(map_from_base);
  const Eigen::Isometry3d marker_from_base =
      marker_.map_from_marker.inverse() * map_from_base.toIsometry();
  for (int row = top; row <= bottom; row += choice.step) {
    for (int column = left; column <= right; column += choice.step) {
      const std::optional<Ray> ray = camera_.rayInBase({column, row});
      const auto position = ray ? meet(*ray, marker_from_base) : std::nullopt;
      if (!position) continue;
      const Cell& cell = cellOf(cells, *position);
      if (!cell.is_visible) continue;
      // The pose may still move by a pixel or two.
      constexpr double kReach = 2.0;
      const Eigen::Vector2d reach = kReach * cell.by_pixel.cwiseAbs().rowwise().sum();
      if ((*position + reach).minCoeff() < 0.0 || (*position - reach).maxCoeff() > width) continue;
      if (choice.thins_even_ground && (column + 2 * (row % 2)) % 4 != 0 &&
          pattern_.isEven(*position - reach, *position + reach)) {
        continue;
      }
      lines_of_sight_.push_back({column, row, *ray});
    }
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
    footprints.push_back({line.column, line.row, *position, sides, cell.by_pose});
  }
  return footprints;
}

std::vector<MarkerPixel> MarkerPatch::pixels(const cv::Mat& panorama,
                                             const Pose2& map_from_base) const {
  const double width = pattern_.width();
  std::vector<MarkerPixel> pixels;
  for (const Footprint& footprint : footprints(map_from_base)) {
    const TagPattern::White white = pattern_.averageOver(
        footprint.position, footprint.by_pixel.col(0), footprint.by_pixel.col(1));
    MarkerPixel pixel;
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
  Cells cells;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const Eigen::Vector2d middle(cell_width * (i + 0.5), cell_width * (j + 0.5));
      Eigen::Matrix<double, 2, 3> pixel_by_pose;
      if (!camera_.pixelFromMap(map_from_base, inMap(middle), &pixel_by_pose)) continue;
      Eigen::Matrix2d pixel_by_position;
      bool is_visible = true;
      for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector2d step = 0.5 * cell_width * Eigen::Vector2d::Unit(axis);
        const auto before = camera_.pixelFromMap(map_from_base, inMap(middle - step));
        const auto after = camera_.pixelFromMap(map_from_base, inMap(middle + step));
        is_visible = is_visible && before && after;
        if (is_visible) pixel_by_position.col(axis) = (*after - *before) / cell_width;
      }
      if (!is_visible || std::abs(pixel_by_position.determinant()) < 1e-6) continue;
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
  return marker_.map_from_marker * (metres_per_module_ * Eigen::Vector3d(position.x() - half,
                                                                         half - position.y(), 0.0));
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
