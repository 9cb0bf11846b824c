#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "omnitag/common/grid_index.h"
#include "omnitag/marker/marker_map.h"

struct apriltag_family;

namespace omnitag {

/// The black and white modules of a tag, with everything that the family's layout fixes around
/// them, as the AprilTag library draws it. Any part of it can be averaged.
///
/// Positions are in modules from the upper left corner of the drawing, x to the right and y down
/// for a person who looks at the upright tag.
class TagPattern {
 public:
  /// Throws InputError for an unknown family, or an id that the family does not have.
  TagPattern(const std::string& family, int id);
  TagPattern(const apriltag_family& family, int id);

  /// Modules across the whole drawing, and between the corners that the library reports, which are
  /// centred in it.
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

  /// What a pixel sees: a parallelogram given by its sides (modules), blurred by a Gaussian of this
  /// variance (pixels squared), and swept along a displacement (modules). If it is sharp, the
  /// parallelogram is cut into four, each of which is averaged as if its sides ran along the
  /// modules. If it is blurred, all of it is a Gaussian, composed of Gaussians along the modules'
  /// axes at a few places on a line, which carry the correlation. The sweep is made in steps of
  /// half a side, if these are not too many.
  class Window {
   public:
    Window() = default;
    Window(const Eigen::Vector2d& side_u, const Eigen::Vector2d& side_v, double blur_variance = 0.0,
           const Eigen::Vector2d& sweep = Eigen::Vector2d::Zero());

    /// How far it reaches from its middle along the modules' axes.
    const Eigen::Vector2d& reach() const { return reach_; }

    /// How far nearly all of it reaches from its middle; all of it if it is sharp. Beyond the
    /// drawing, the drawing's edge is continued.
    const Eigen::Vector2d& core() const { return core_; }

    bool isBlurred() const { return is_blurred_; }

    /// The size of a rectangle along the modules' axes that approximates all of it.
    const Eigen::Vector2d& size() const { return size_; }

   private:
    friend class TagPattern;
    /// One of the rectangles or Gaussians that it is made of.
    struct Place {
      Eigen::Vector2d from_middle = Eigen::Vector2d::Zero();
      double share = 0.0;
    };
    void add(const Eigen::Vector2d& from_middle, double share) {
      places_[place_count_++] = {from_middle, share};
    }

    /// Calls `visit` with the middle of each place, at each step of the sweep, and its share.
    template <typename Visit>
    void visit(const Eigen::Vector2d& position, const Visit& visit) const {
      const double per_step = 1.0 / steps_;
      for (int i = 0; i < steps_; ++i) {
        const Eigen::Vector2d middle = position + (i - 0.5 * (steps_ - 1)) * step_;
        for (std::size_t k = 0; k < place_count_; ++k) {
          visit(middle + places_[k].from_middle, per_step * places_[k].share);
        }
      }
    }

    Eigen::Vector2d reach_ = Eigen::Vector2d::Zero();
    Eigen::Vector2d core_ = Eigen::Vector2d::Zero();
    Eigen::Vector2d size_ = Eigen::Vector2d::Zero();
    std::array<Place, 5> places_{};
    std::size_t place_count_ = 0;
    /// At each place: half the sides of rectangles, the standard deviations of Gaussians.
    Eigen::Vector2d extent_ = Eigen::Vector2d::Zero();
    Eigen::Vector2d step_ = Eigen::Vector2d::Zero();
    int steps_ = 1;
    bool is_blurred_ = false;
  };

  /// Average over a window about a position; its core must lie within the drawing.
  White averageOver(const Eigen::Vector2d& position, const Window& window) const;

  bool isWhite(int column, int row) const;

  /// Whether everything within `reach` (modules along either axis) of a position, as far as the
  /// drawing has it, is of one colour. Only adjacent modules are checked: false if the reach is
  /// more than 1. The position may be off the drawing by the reach at most.
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

  /// The number of modules that distinguish the tags of a family; the layout fixes the others.
  int dataModules() const { return data_modules_; }

  /// A data module, by its number in the order of the family's bits, and its share in a window.
  struct DataShare {
    int module;
    double share;
  };

  /// Appends the shares of the data modules in what a window sees, each module once; modules
  /// without a share may be missing. For a sharp window, the shares in the rectangle of its size().
  void appendDataShares(const Eigen::Vector2d& position, const Window& window,
                        std::vector<DataShare>* shares) const;

  /// Whether a data module is white.
  bool isDataWhite(int module) const {
    return is_data_white_[static_cast<std::size_t>(module)] != 0;
  }

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
  /// up to 1, and their derivatives by its middle.
  struct Profile {
    static constexpr int kMost = 32;
    int first = 0;
    int count = 0;
    std::array<double, kMost> shares{};
    std::array<double, kMost> slopes{};
  };
  Profile profileOf(double middle, double deviation) const;
  White averageOverGaussian(const Eigen::Vector2d& middle, const Eigen::Vector2d& deviations) const;
  void compareNeighbours();
  Place placeOf(double coordinate) const;
  Area whiteAbove(const Place& x, const Place& y) const;
  /// `per_area`: 1 / the area between.
  White averageBetween(const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                       double per_area) const;
  bool isWhiteAt(const Eigen::Vector2d& position) const;
  int moduleAt(double coordinate) const {
    return std::clamp(static_cast<int>(coordinate), 0, width_ - 1);
  }
  std::size_t moduleIndex(int column, int row) const { return gridIndex(column, row, width_); }
  std::size_t cornerIndex(int column, int row) const { return gridIndex(column, row, width_ + 1); }

  int width_ = 0;
  int width_between_corners_ = 0;
  int data_modules_ = 0;
  /// Row by row, 1 for white.
  std::vector<char> is_white_;
  /// White modules above and to the left of each corner of the grid.
  std::vector<double> sums_;
  /// For each module, and for those around the drawing, which equal the nearest ones: a bit for
  /// each of the 3 x 3 neighbours, row by row, that has another colour.
  std::vector<std::uint16_t> unlike_neighbours_;
  /// Number of each data module, row by row; -1 for the others.
  std::vector<int> data_module_;
  /// One for each data module.
  std::vector<char> is_data_white_;
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
