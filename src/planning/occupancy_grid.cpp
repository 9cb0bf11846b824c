#include "planning/occupancy_grid.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "common/yaml_reader.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr double kWhite = 255.0;

double occupancyOf(std::uint8_t value, bool negate) {
  return negate ? value / kWhite : (kWhite - value) / kWhite;
}

Cell cellOf(double occupancy, const GridFile& file) {
  if (occupancy > file.occupied_threshold) return Cell::kOccupied;
  return occupancy < file.free_threshold ? Cell::kFree : Cell::kUnknown;
}

/// A line's way along one axis of the grid: the cell it is in, and the shares of the line at which
/// it enters the next one.
struct Axis {
  int cell;
  int step;
  double next;
  double per_cell;

  Axis(double from, double to)
      : cell(static_cast<int>(std::floor(from))),
        step(to > from ? 1 : -1),
        next(std::numeric_limits<double>::infinity()),
        per_cell(next) {
    if (to == from) return;
    const double border = step > 0 ? cell + 1.0 : cell;
    next = (border - from) / (to - from);
    per_cell = 1.0 / std::abs(to - from);
  }

  void advance() {
    cell += step;
    next += per_cell;
  }
};

}  // namespace

GridFile loadGridFile(const std::string& path) {
  const YamlReader reader = YamlReader::fromFile(path);
  GridFile file;
  const std::filesystem::path image = reader.text("image");
  if (image.empty()) reader.refuse("image", "the name of an image");
  file.image = image.is_absolute() ? image.string()
                                   : (std::filesystem::path(path).parent_path() / image).string();
  file.resolution = reader.number("resolution", kPositive);
  const std::vector<double> origin = reader.numbers("origin", 3);
  file.origin = {origin[0], origin[1], origin[2]};
  file.negate = reader.integer("negate", {0.0, 1.0}) == 1;
  file.occupied_threshold = reader.number("occupied_thresh", {0.0, 1.0});
  file.free_threshold = reader.number("free_thresh", {0.0, 1.0});
  if (file.free_threshold > file.occupied_threshold) {
    reader.refuse("free_thresh", "a number <= occupied_thresh");
  }
  std::string mode = "trinary";
  reader.read("mode", &mode);
  if (mode != "trinary" && mode != "scale") reader.refuse("mode", "trinary or scale");
  return file;
}

OccupancyGrid::OccupancyGrid(const cv::Mat& image, const GridFile& file)
    : columns_(image.cols), rows_(image.rows), resolution_(file.resolution) {
  if (image.empty() || image.type() != CV_8UC1) {
    throw InputError(file.image + ": expected an image of at least one pixel");
  }
  map_from_grid_ =
      Eigen::Translation2d(file.origin.head<2>()) * Eigen::Rotation2Dd(file.origin.z());
  cells_.reserve(image.total());
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const auto value = image.at<std::uint8_t>(rows_ - 1 - row, column);
      cells_.push_back(cellOf(occupancyOf(value, file.negate), file));
    }
  }
}

Eigen::Vector2d OccupancyGrid::mapFromCells(const Eigen::Vector2d& cells) const {
  return map_from_grid_ * Eigen::Vector2d(resolution_ * cells);
}

Eigen::Vector2d OccupancyGrid::cellsFromMap(const Eigen::Vector2d& point) const {
  return map_from_grid_.inverse() * point / resolution_;
}

Cell OccupancyGrid::at(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d cells = cellsFromMap(point).array().floor();
  // Compared before the conversion to integers, which could not hold points far off the grid.
  if (!(cells.minCoeff() >= 0.0 && cells.x() < columns_ && cells.y() < rows_)) {
    return Cell::kUnknown;
  }
  return at(static_cast<int>(cells.x()), static_cast<int>(cells.y()));
}

bool OccupancyGrid::isClear(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  if (at(from) != Cell::kFree || at(to) != Cell::kFree) return false;
  const Eigen::Vector2d begin = cellsFromMap(from);
  const Eigen::Vector2d end = cellsFromMap(to);
  Axis x(begin.x(), end.x());
  Axis y(begin.y(), end.y());
  while (std::min(x.next, y.next) <= 1.0) {
    (x.next < y.next ? x : y).advance();
    if (at(x.cell, y.cell) != Cell::kFree) return false;
  }
  return true;
}

std::vector<double> OccupancyGrid::clearances() const {
  // With a frame that is not free, since everything off the grid is unknown.
  cv::Mat free(rows_ + 2, columns_ + 2, CV_8UC1, cv::Scalar(0));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      if (at(column, row) == Cell::kFree) free.at<std::uint8_t>(row + 1, column + 1) = 1;
    }
  }
  cv::Mat distances;
  cv::distanceTransform(free, distances, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  std::vector<double> clearances;
  clearances.reserve(cells_.size());
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      clearances.push_back(resolution_ * distances.at<float>(row + 1, column + 1));
    }
  }
  return clearances;
}

}  // namespace omnitag
