#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/grid_index.h"
#include "marker/pattern_picture.h"
#include "marker/pattern_window.h"
#include "omnitag/marker/marker_map.h"

struct apriltag_family;

namespace omnitag {

/// What is printed on a marker: black and white modules, or the grey ones of a picture, with
/// everything that the family's layout fixes around them. Any part of it can be averaged.
///
/// Positions are in modules from the upper left corner of the drawing, x to the right and y down
/// for a person who looks at the upright marker.
class TagPattern {
 public:
  /// As the AprilTag library draws it. Throws InputError for an unknown family, or an id that the
  /// family does not have.
  TagPattern(const std::string& family, int id);
  TagPattern(const apriltag_family& family, int id);
  /// Each cell of a picture consists of enough modules to make its border a whole number of them.
  explicit TagPattern(const PatternPicture& picture);
  /// Throws InputError as above.
  explicit TagPattern(const Marker& marker);

  /// Modules across the whole drawing, and between the corners that the library reports, which are
  /// centred in it.
  int width() const { return width_; }
  int widthBetweenCorners() const { return width_between_corners_; }

  /// Share of white, from 0 to 1, and its derivatives with respect to the position, per module.
  struct White {
    double share = 0.0;
    Eigen::Vector2d by_position = Eigen::Vector2d::Zero();
  };

  /// Average over a rectangle of the given size (> 0) about a position; the rectangle must lie
  /// within the drawing.
  White average(const Eigen::Vector2d& position, const Eigen::Vector2d& size) const;

  /// What a pixel sees.
  using Window = PatternWindow;

  /// Average over a window about a position; its core must lie within the drawing.
  White averageOver(const Eigen::Vector2d& position, const Window& window) const;

  /// A module's share of white.
  double whiteAt(int column, int row) const { return white_[moduleIndex(column, row)]; }

  /// Modules over which the pattern hardly varies: 1 for codes, whose modules are independent; for
  /// a picture, the width of its independent parts, or of its border if that is less.
  double featureWidth() const { return feature_width_; }

  /// Whether everything on the drawing within `reach` (modules along either axis) of a position is
  /// of one colour. Only adjacent modules are checked: false if the reach is more than 1. The
  /// position may be off the drawing by the reach at most.
  bool isEvenAround(const Eigen::Vector2d& position, const Eigen::Vector2d& reach) const {
    if (reach.maxCoeff() > 1.0) return false;
    // From one module above and to the left of the first, so that none is negative.
    const Eigen::Vector2d place = position + Eigen::Vector2d::Ones();
    const int column = std::min(static_cast<int>(place.x()), width_ + 1);
    const int row = std::min(static_cast<int>(place.y()), width_ + 1);
    const double right = place.x() - column;
    const double down = place.y() - row;
    const unsigned columns =
        2U | (right < reach.x() ? 1U : 0U) | (right > 1.0 - reach.x() ? 4U : 0U);
    const unsigned rows = 8U | (down < reach.y() ? 1U : 0U) | (down > 1.0 - reach.y() ? 64U : 0U);
    const unsigned unlike = unlike_neighbours_[gridIndex(column, row, width_ + 2)];
    return (columns * rows & unlike) == 0U;
  }

  /// The number of modules that distinguish the markers of a family, or of a picture's cells; the
  /// layout fixes the others.
  int dataModules() const { return static_cast<int>(data_.size()); }

  /// The area of all data modules, in modules squared. It exceeds dataModules() for a picture whose
  /// cells consist of several modules.
  double dataArea() const { return data_area_; }

  /// The number of independent ways in which the data modules of such markers vary: infinite for
  /// codes, whose modules are independent however many there are; dimensionsOf() a picture.
  double dataDimensions() const { return data_dimensions_; }

  /// A data module, by its number in the order of the family's bits, and its share in a window.
  struct DataShare {
    int module;
    double share;
  };

  /// Appends the shares of the data modules in what a window sees, each module once; modules
  /// without a share may be missing. For a sharp window, the shares in the rectangle of its size().
  void appendDataShares(const Eigen::Vector2d& position, const Window& window,
                        std::vector<DataShare>* shares) const;

  /// What a data module shows, from -1 (black) to 1 (white).
  double dataAt(int module) const { return data_[static_cast<std::size_t>(module)]; }

 private:
  /// White area above and to the left of a position, in modules squared, and its derivatives.
  struct Area {
    double area;
    double by_x;
    double by_y;
  };
  /// A coordinate as the module that contains it, and the distance from the module's beginning.
  struct Place {
    int module;
    double within;
  };
  /// What a Gaussian sees along one axis: the shares of `count` modules from `first` on, which add
  /// up to 1, and their derivatives with respect to its middle.
  struct Profile {
    static constexpr int kMost = 32;
    int first = 0;
    int count = 0;
    std::array<double, kMost> shares{};
    std::array<double, kMost> slopes{};
  };
  /// Works out what the modules' shares of white imply.
  void prepare();
  Profile profileOf(double middle, double deviation) const;
  White averageOverGaussian(const Eigen::Vector2d& middle, const Eigen::Vector2d& deviations) const;
  void compareNeighbours();
  Place placeOf(double coordinate) const;
  /// The nearest position at which a rectangle with these half sides lies within the drawing.
  Eigen::Vector2d withinDrawing(const Eigen::Vector2d& position,
                                const Eigen::Vector2d& half) const {
    return position.cwiseMin(Eigen::Vector2d::Constant(width_) - half).cwiseMax(half);
  }
  Area whiteAbove(const Place& x, const Place& y) const;
  /// `per_area`: 1 / the area between.
  White averageBetween(const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                       double per_area) const;
  double whiteAt(const Eigen::Vector2d& position) const;
  int moduleAt(double coordinate) const {
    return std::clamp(static_cast<int>(coordinate), 0, width_ - 1);
  }
  std::size_t moduleIndex(int column, int row) const { return gridIndex(column, row, width_); }
  std::size_t cornerIndex(int column, int row) const { return gridIndex(column, row, width_ + 1); }

  int width_ = 0;
  int width_between_corners_ = 0;
  double feature_width_ = 1.0;
  double data_area_ = 0.0;
  double data_dimensions_ = std::numeric_limits<double>::infinity();
  /// Row by row, the share of white.
  std::vector<double> white_;
  /// White area above and to the left of each corner of the grid.
  std::vector<double> sums_;
  /// For each module, and for those around the drawing, which equal the nearest ones: a bit for
  /// each of the 3 x 3 neighbours, row by row, that has another colour.
  std::vector<std::uint16_t> unlike_neighbours_;
  /// Number of each data module, row by row; -1 for the others.
  std::vector<int> data_module_;
  /// One for each data module.
  std::vector<double> data_;
};

/// The patterns of a map's markers, each drawn once.
class TagPatterns {
 public:
  /// Throws InputError as TagPattern does.
  explicit TagPatterns(const MarkerMap& map) { add(map); }

  /// Draws the patterns that are missing. Throws InputError as TagPattern does.
  void add(const MarkerMap& map);

  const TagPattern& of(const Marker& marker) const;

 private:
  std::map<std::pair<std::string, int>, TagPattern> patterns_;
};

}  // namespace omnitag
