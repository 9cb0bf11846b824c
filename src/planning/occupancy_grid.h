#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "common/grid_index.h"

namespace omnitag {

/// The YAML file of an occupancy grid, as map_server reads it.
struct GridFile {
  /// Path of the image, relative to the working directory or absolute.
  std::string image;
  /// m, edge of a cell.
  double resolution = 0.0;
  /// m, m and rad: the lower left corner of the image's lower left pixel in the map, and the
  /// direction of the image's rows there.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  /// Whether white is occupied and black is free.
  bool negate = false;
  /// Cells whose probability is above the first are occupied, below the second free.
  double occupied_threshold = 0.65;
  double free_threshold = 0.196;
};

/// Reads such a file. Throws InputError with one line that names the file, the line and the key if
/// something is missing, out of its range, or of a mode that does not tell occupied from free.
GridFile loadGridFile(const std::string& path);

enum class Cell : std::uint8_t { kFree, kOccupied, kUnknown };

/// Which parts of a building's floor are free, occupied, or unknown. Everything off the grid is
/// unknown. Columns and rows are counted from the grid's origin, rows upward.
class OccupancyGrid {
 public:
  /// `image`: CV_8UC1, the first row on top. A pixel of value v is occupied with the probability
  /// (255 - v) / 255, or v / 255 if negated; see GridFile. Throws InputError for an empty image.
  OccupancyGrid(const cv::Mat& image, const GridFile& file);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  /// m, edge of a cell.
  double resolution() const { return resolution_; }

  Cell at(int column, int row) const {
    const bool is_inside = column >= 0 && column < columns_ && row >= 0 && row < rows_;
    return is_inside ? cells_[gridIndex(column, row, columns_)] : Cell::kUnknown;
  }

  /// The cell at a point of the map (m).
  Cell at(const Eigen::Vector2d& point) const;

  /// m, in the map: the middle of a cell, or any other place in cells from the grid's origin.
  Eigen::Vector2d mapFromCells(const Eigen::Vector2d& cells) const;
  Eigen::Vector2d cellsFromMap(const Eigen::Vector2d& point) const;
  Eigen::Vector2d middleOf(int column, int row) const {
    return mapFromCells({column + 0.5, row + 0.5});
  }

  /// Whether all cells that the line between two points of the map (m) touches are free: the grid
  /// is traversed from cell to cell (Amanatides and Woo 1987).
  bool isClear(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  /// m, from the middle of each cell to the middle of the nearest one that is not free, row by row;
  /// 0 for those that are not free themselves.
  std::vector<double> clearances() const;

 private:
  int columns_ = 0;
  int rows_ = 0;
  double resolution_ = 0.0;
  Eigen::Isometry2d map_from_grid_ = Eigen::Isometry2d::Identity();
  std::vector<Cell> cells_;
};

}  // namespace omnitag
