#include "photometry/pixel_sorter.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace omnitag {
namespace {

/// A polynomial of the third degree, by its coefficients.
struct Cubic {
  Eigen::Vector2d constant;
  Eigen::Vector2d linear;
  Eigen::Vector2d quadratic;
  Eigen::Vector2d cubic;

  /// Through values at 0, 1, 2 and 3.
  static Cubic through(const std::array<Eigen::Vector2d, 4>& values) {
    const auto& [a, b, c, d] = values;
    return {a, (-11.0 * a + 18.0 * b - 9.0 * c + 2.0 * d) / 6.0,
            (2.0 * a - 5.0 * b + 4.0 * c - d) / 2.0, (3.0 * (b - c) + d - a) / 6.0};
  }

  Eigen::Vector2d at(double x) const {
    return constant + x * (linear + x * (quadratic + x * cubic));
  }
};

/// A polynomial of the third degree in both directions.
class Bicubic {
 public:
  /// Through values at 0, 1, 2 and 3 in each direction; `rows` are the polynomials along the first.
  explicit Bicubic(const std::array<Cubic, 4>& rows)
      : constant_(across(rows, &Cubic::constant)),
        linear_(across(rows, &Cubic::linear)),
        quadratic_(across(rows, &Cubic::quadratic)),
        cubic_(across(rows, &Cubic::cubic)) {}

  Cubic alongRow(double y) const {
    return {constant_.at(y), linear_.at(y), quadratic_.at(y), cubic_.at(y)};
  }

 private:
  static Cubic across(const std::array<Cubic, 4>& rows, Eigen::Vector2d Cubic::*part) {
    return Cubic::through({rows[0].*part, rows[1].*part, rows[2].*part, rows[3].*part});
  }

  Cubic constant_;
  Cubic linear_;
  Cubic quadratic_;
  Cubic cubic_;
};

/// Spacings between the nodes of a Bicubic, in each direction.
constexpr int kSpacings = 3;

/// Steps along either side of a cell, whose pixels are tested together for even ground. A block
/// consists of whole cells.
constexpr int kCell = kSpacings;

/// Steps of the grid of considered pixels, along columns and rows (pixels).
Eigen::Vector2i stepsFor(double area, std::size_t max_considered) {
  const double wanted = std::max(1.0, area / static_cast<double>(max_considered));
  const int smaller = std::max(1, static_cast<int>(std::sqrt(wanted)));
  return {std::max(smaller, static_cast<int>(wanted / smaller)), smaller};
}

class Sorter {
 public:
  Sorter(const TagPattern& pattern, const MountedCamera& camera, const DrawingPlane& plane,
         const FacetGrid& facets, const MarkerPatch::Choice& choice)
      : pattern_(pattern),
        camera_(camera),
        plane_(plane),
        facets_(facets),
        step_(stepsFor(facets.area(), choice.max_considered)),
        block_(blockOf(step_.x(), choice.tolerance), blockOf(step_.y(), choice.tolerance)),
        reach_(Eigen::Vector2d::Constant(choice.reach)),
        tells_apart_(choice.max_at_edges < choice.max_considered ||
                     choice.max_on_even_ground < choice.max_considered) {
    constexpr std::size_t kMostReserved = 2000;
    const std::size_t most = std::min(choice.max_considered, kMostReserved);
    sorted_.at_edges.reserve(most);
    sorted_.on_even_ground.reserve(most);
  }

  SortedPixels sort() {
    const PixelBox& box = facets_.box();
    // Blocks this small would have as many nodes as pixels.
    if (block_ == kSpacings * step_) {
      sortOneByOne(box);
      return std::move(sorted_);
    }
    for (int top = box.top; top <= box.bottom; top += block_.y()) {
      for (int left = box.left; left <= box.right; left += block_.x()) {
        sortBlock({left, top, std::min(left + block_.x() - 1, box.right),
                   std::min(top + block_.y() - 1, box.bottom)});
      }
    }
    return std::move(sorted_);
  }

 private:
  /// Side of a block of pixels in which positions may be interpolated between nodes; a whole number
  /// of steps between nodes.
  int blockOf(int step, double tolerance) const {
    // Interpolated between nodes h pixels apart, positions are off by up to this times h^4 / r^3 at
    // r pixels from the middle of the image; measured in the test PositionsAreWhatThePixelsSee.
    constexpr double kError = 7.0;
    const PixelBox& box = facets_.box();
    const Eigen::Vector2d middle(0.5 * (box.left + box.right), 0.5 * (box.top + box.bottom));
    const double radius = (middle - camera_.model().imagePlane().principalPoint()).norm();
    const double spacing = std::pow(tolerance * radius * radius * radius / kError, 0.25);
    return kSpacings * step * std::max(1, static_cast<int>(spacing / step));
  }

  std::optional<Eigen::Vector2d> positionAt(int column, int row) const {
    const std::optional<Ray> ray = camera_.tabulatedRayInBase({column, row});
    return ray ? plane_.meet(*ray) : std::nullopt;
  }

  /// Half extent (modules) around a position of what the pixel there, or one `beside` pixels away,
  /// may turn out to see.
  Eigen::Vector2d surroundingsAt(const Eigen::Vector2d& position,
                                 const Eigen::Vector2d& beside) const {
    const Facet& facet = facets_.at(position);
    return facet.window.reach() + facet.by_pixel.cwiseAbs() * (reach_ + beside);
  }

  /// Positions as a function of columns and rows in spacings of nodes; nothing if a node does not
  /// see the plane.
  std::optional<Bicubic> positionsIn(const PixelBox& block) const {
    const Eigen::Vector2i spacing = block_ / kSpacings;
    std::array<Cubic, kSpacings + 1> along_rows;
    for (int i = 0; i <= kSpacings; ++i) {
      std::array<Eigen::Vector2d, kSpacings + 1> nodes;
      for (int k = 0; k <= kSpacings; ++k) {
        const auto node = positionAt(block.left + k * spacing.x(), block.top + i * spacing.y());
        if (!node) return std::nullopt;
        nodes[static_cast<std::size_t>(k)] = *node;
      }
      along_rows[static_cast<std::size_t>(i)] = Cubic::through(nodes);
    }
    return Bicubic(along_rows);
  }

  void sortBlock(const PixelBox& block) {
    const std::optional<Bicubic> positions = positionsIn(block);
    if (!positions) return sortOneByOne(block);
    const Eigen::Vector2d per_pixel = kSpacings * block_.cast<double>().cwiseInverse();
    for (int top = block.top; top <= block.bottom; top += kCell * step_.y()) {
      std::array<Cubic, kCell> rows;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const int row = top + static_cast<int>(i) * step_.y();
        rows[i] = positions->alongRow(per_pixel.y() * (row - block.top));
      }
      const int bottom = std::min(top + kCell * step_.y() - 1, block.bottom);
      sortCells({block.left, top, block.right, bottom}, rows, per_pixel.x());
    }
  }

  /// One row of cells, given the positions along its rows of pixels. Most pixels see even ground,
  /// mostly as whole cells.
  void sortCells(const PixelBox& cells, const std::array<Cubic, kCell>& rows, double per_pixel) {
    constexpr int kMiddle = kCell / 2;
    const Cubic& middle = rows[kMiddle];
    const int middle_row = cells.top + kMiddle * step_.y();
    const Eigen::Vector2d amid = middle.at(0.5 * per_pixel * (cells.right - cells.left));
    const Eigen::Vector2d around_pixel = surroundingsAt(amid, Eigen::Vector2d::Zero());
    const Eigen::Vector2d around_cell = surroundingsAt(amid, step_.cast<double>());
    for (int left = cells.left; left <= cells.right; left += kCell * step_.x()) {
      const int right = std::min(left + kCell * step_.x() - 1, cells.right);
      const int column = left + kMiddle * step_.x();
      const Eigen::Vector2d position = middle.at(per_pixel * (column - cells.left));
      if (isOff(position, around_cell)) continue;
      if (isEven(position, around_cell)) {
        const bool is_there = column <= right && middle_row <= cells.bottom;
        if (is_there) sorted_.on_even_ground.push_back({column, middle_row, position});
        continue;
      }
      const Cubic* along_row = rows.data();
      for (int row = cells.top; row <= cells.bottom; row += step_.y(), ++along_row) {
        for (int x = left; x <= right; x += step_.x()) {
          add(x, row, along_row->at(per_pixel * (x - cells.left)), around_pixel);
        }
      }
    }
  }

  void sortOneByOne(const PixelBox& block) {
    for (int row = block.top; row <= block.bottom; row += step_.y()) {
      for (int column = block.left; column <= block.right; column += step_.x()) {
        const auto position = positionAt(column, row);
        if (position) {
          add(column, row, *position, surroundingsAt(*position, Eigen::Vector2d::Zero()));
        }
      }
    }
  }

  bool isOff(const Eigen::Vector2d& position, const Eigen::Vector2d& surroundings) const {
    return (position + surroundings).minCoeff() < 0.0 ||
           (position - surroundings).maxCoeff() > static_cast<double>(pattern_.width());
  }

  bool isEven(const Eigen::Vector2d& position, const Eigen::Vector2d& surroundings) const {
    return tells_apart_ && pattern_.isEvenAround(position, surroundings);
  }

  void add(int column, int row, const Eigen::Vector2d& position,
           const Eigen::Vector2d& surroundings) {
    if (isOff(position, surroundings)) return;
    (isEven(position, surroundings) ? sorted_.on_even_ground : sorted_.at_edges)
        .push_back({column, row, position});
  }

  const TagPattern& pattern_;
  const MountedCamera& camera_;
  const DrawingPlane& plane_;
  const FacetGrid& facets_;
  Eigen::Vector2i step_;
  /// Pixels along columns and rows.
  Eigen::Vector2i block_;
  /// Pixels.
  Eigen::Vector2d reach_;
  bool tells_apart_;
  SortedPixels sorted_;
};

}  // namespace

SortedPixels sortPixels(const TagPattern& pattern, const MountedCamera& camera,
                        const DrawingPlane& plane, const FacetGrid& facets,
                        const MarkerPatch::Choice& choice) {
  return Sorter(pattern, camera, plane, facets, choice).sort();
}

}  // namespace omnitag
