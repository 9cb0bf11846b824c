#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace omnitag {

/// The black and white modules of a tag with all that the family's layout fixes around them, as the
/// AprilTag library draws it, for averages over any part of it.
///
/// Positions are in modules from the upper left corner of the drawing, x to the right and y down as
/// a person sees them who looks at the upright tag.
class TagPattern {
 public:
  /// Throws InputError for a family that the library does not have or an id that it has not.
  TagPattern(const std::string& family, int id);

  /// Modules across the whole drawing, and between the corners that the library reports, which lie
  /// in the middle of it.
  int width() const { return width_; }
  int widthBetweenCorners() const { return width_between_corners_; }

  /// Share of white, from 0 to 1, and its derivatives by the position, per module.
  struct White {
    double share = 0.0;
    Eigen::Vector2d by_position = Eigen::Vector2d::Zero();
  };

  /// Average over a rectangle of the given size (> 0) about a position; the rectangle must lie
  /// within the drawing.
  White average(const Eigen::Vector2d& position, const Eigen::Vector2d& size) const;

  bool isWhite(int column, int row) const;

 private:
  /// White area above and to the left of a position, in modules squared, and its derivatives.
  struct Area {
    double area;
    double by_x;
    double by_y;
  };
  Area whiteAbove(double x, double y) const;
  double sumAt(int column, int row) const;
  std::size_t indexOf(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_ + 1) +
           static_cast<std::size_t>(column);
  }

  int width_ = 0;
  int width_between_corners_ = 0;
  /// White modules above and to the left of each corner of the grid.
  std::vector<double> sums_;
};

}  // namespace omnitag
