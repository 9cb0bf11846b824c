#include "omnitag/localization/marker_patch.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "drawing_plane.h"
#include "node_grid.h"

namespace omnitag {
namespace {

/// Pixels.
constexpr std::size_t kMostReserved = 2000;

}  // namespace

MarkerPatch::MarkerPatch(const Marker& marker, const TagPattern& pattern,
                         const MountedCamera& camera, const Pose2& map_from_base, double blur,
                         const Choice& choice)
    : marker_(marker),
      pattern_(pattern),
      camera_(camera),
      metres_per_module_(marker.size / pattern.widthBetweenCorners()),
      facets_along_(choice.facets) {
  const Nodes nodes = nodesAt(map_from_base);
  setFacets(nodes, map_from_base, blur);
  choosePlaces(map_from_base, boundingBox(nodes), choice);
}

inline const Facet& MarkerPatch::facetOf(const Eigen::Vector2d& position) const {
  const double facets_per_module = static_cast<double>(facets_along_) / pattern_.width();
  const auto indexAlong = [&](double coordinate) {
    return std::clamp(static_cast<int>(coordinate * facets_per_module), 0, facets_along_ - 1);
  };
  return facets_[gridIndex(indexAlong(position.x()), indexAlong(position.y()), facets_along_)];
}

MarkerPatch::Nodes MarkerPatch::nodesAt(const Pose2& map_from_base) const {
  // A drawing images so smoothly that a few nodes tell where all others are.
  if (facets_along_ > kProjectedFacets) {
    auto nodes = interpolated(projectedNodes(map_from_base, kProjectedFacets), facets_along_);
    if (nodes) return *nodes;
  }
  return projectedNodes(map_from_base, facets_along_);
}

MarkerPatch::Nodes MarkerPatch::projectedNodes(const Pose2& map_from_base, int facets) const {
  const double width = static_cast<double>(pattern_.width()) / facets;
  Nodes nodes;
  nodes.reserve(gridIndex(0, facets + 1, facets + 1));
  for (int row = 0; row <= facets; ++row) {
    for (int column = 0; column <= facets; ++column) {
      nodes.push_back(camera_.pixelFromMap(map_from_base, inMap({width * column, width * row})));
    }
  }
  return nodes;
}

void MarkerPatch::setFacets(const Nodes& nodes, const Pose2& map_from_base, double blur) {
  const DrawingPlane plane(marker_, pattern_, map_from_base);
  const double width = static_cast<double>(pattern_.width()) / facets_along_;
  // A Gaussian blur and a box have the same variance where the box is sqrt(12) deviations wide.
  const double stretch = std::sqrt(1.0 + 12.0 * blur * blur);
  const auto nodeAt = [&](int column, int row) -> const std::optional<Eigen::Vector2d>& {
    return nodes[gridIndex(column, row, facets_along_ + 1)];
  };
  for (int row = 0; row < facets_along_; ++row) {
    for (int column = 0; column < facets_along_; ++column) {
      Facet& facet = facets_.emplace_back();
      const auto& upper_left = nodeAt(column, row);
      const auto& upper_right = nodeAt(column + 1, row);
      const auto& lower_left = nodeAt(column, row + 1);
      const auto& lower_right = nodeAt(column + 1, row + 1);
      if (!upper_left || !upper_right || !lower_left || !lower_right) continue;
      Eigen::Matrix2d pixel_by_position;
      pixel_by_position << *upper_right + *lower_right - *upper_left - *lower_left,
          *lower_left + *lower_right - *upper_left - *upper_right;
      pixel_by_position /= 2.0 * width;
      if (std::abs(pixel_by_position.determinant()) < 1e-6) continue;
      const auto ray = camera_.tabulatedRayInBase(
          0.25 * (*upper_left + *upper_right + *lower_left + *lower_right));
      if (!ray || !plane.meet(*ray)) continue;
      facet.is_visible = true;
      facet.by_pixel = pixel_by_position.inverse();
      facet.by_pose = plane.derivative(*ray);
      facet.window =
          TagPattern::Window(stretch * facet.by_pixel.col(0), stretch * facet.by_pixel.col(1));
    }
  }
}

MarkerPatch::Box MarkerPatch::boundingBox(const Nodes& nodes) const {
  const ImageSize& size = camera_.model().imageSize();
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

Eigen::Vector2i MarkerPatch::gridSteps(std::size_t max_considered) const {
  const double facet_width = static_cast<double>(pattern_.width()) / facets_along_;
  double area = 0.0;  // pixels
  for (const Facet& facet : facets_) {
    if (facet.is_visible) {
      area += facet_width * facet_width / std::abs(facet.by_pixel.determinant());
    }
  }
  const double wanted = std::max(1.0, area / static_cast<double>(max_considered));
  const int smaller = std::max(1, static_cast<int>(std::sqrt(wanted)));
  return {std::max(smaller, static_cast<int>(wanted / smaller)), smaller};
}

/// Tells pixels at edges from those on even ground.
class MarkerPatch::Sorter {
 public:
  Sorter(const MarkerPatch& patch, const Pose2& map_from_base, const Box& box, const Choice& choice)
      : patch_(patch),
        plane_(patch.marker_, patch.pattern_, map_from_base),
        step_(patch.gridSteps(choice.max_considered)),
        block_(blockOf(step_.x(), box, choice.tolerance),
               blockOf(step_.y(), box, choice.tolerance)),
        reach_(choice.reach),
        tells_apart_(choice.max_at_edges < choice.max_considered ||
                     choice.max_on_even_ground < choice.max_considered) {
    const std::size_t most = std::min(choice.max_considered, kMostReserved);
    at_edges_.reserve(most);
    on_even_ground_.reserve(most);
  }

  void sort(const Box& box) {
    // Of blocks so small, there would be as many nodes as pixels.
    if (block_ == 2 * step_) return sortOneByOne(box);
    for (int top = box.top; top <= box.bottom; top += block_.y()) {
      const int bottom = std::min(top + block_.y() - 1, box.bottom);
      NodeColumn left_nodes = nodesBelow(box.left, top);
      for (int left = box.left; left <= box.right; left += block_.x()) {
        const NodeColumn middle_nodes = nodesBelow(left + block_.x() / 2, top);
        const NodeColumn right_nodes = nodesBelow(left + block_.x(), top);
        sortBlock({left, top, std::min(left + block_.x() - 1, box.right), bottom}, left_nodes,
                  middle_nodes, right_nodes);
        left_nodes = right_nodes;
      }
    }
  }

  const std::vector<Place>& atEdges() const { return at_edges_; }
  const std::vector<Place>& onEvenGround() const { return on_even_ground_; }

 private:
  /// A polynomial of the second degree, by its coefficients.
  struct Parabola {
    Eigen::Vector2d constant;
    Eigen::Vector2d linear;
    Eigen::Vector2d quadratic;

    /// Through values at 0, 1 and 2.
    static Parabola through(const Eigen::Vector2d& first, const Eigen::Vector2d& middle,
                            const Eigen::Vector2d& last) {
      return {first, 2.0 * middle - 1.5 * first - 0.5 * last, 0.5 * (first + last) - middle};
    }

    Eigen::Vector2d at(double x) const { return constant + x * (linear + x * quadratic); }
  };

  /// Positions at three rows of a block; nothing where one of them is not seen.
  using NodeColumn = std::optional<std::array<Eigen::Vector2d, 3>>;

  NodeColumn nodesBelow(int column, int top) const {
    const auto first = positionAt(column, top);
    const auto middle = positionAt(column, top + block_.y() / 2);
    const auto last = positionAt(column, top + block_.y());
    if (!first || !middle || !last) return std::nullopt;
    return {{*first, *middle, *last}};
  }

  /// The side, a whole and even number of steps, of a block of pixels in which positions may follow
  /// from those of three times three nodes.
  int blockOf(int step, const Box& box, double tolerance) const {
    // Interpolated between nodes that are h pixels apart, they are off by up to this times h^3 /
    // r^2 at r pixels from the middle of the image: measured in PositionsAreWhatThePixelsSee.
    constexpr double kError = 1.7;
    const Eigen::Vector2d middle(0.5 * (box.left + box.right), 0.5 * (box.top + box.bottom));
    const double radius = (middle - patch_.camera_.model().imagePlane().principalPoint()).norm();
    const double spacing = std::cbrt(tolerance * radius * radius / kError);
    return 2 * step * std::max(1, static_cast<int>(spacing / step));
  }

  std::optional<Eigen::Vector2d> positionAt(int column, int row) const {
    const std::optional<Ray> ray = patch_.camera_.tabulatedRayInBase({column, row});
    return ray ? plane_.meet(*ray) : std::nullopt;
  }

  /// Modules around a position that a pixel there may turn out to see.
  Eigen::Vector2d surroundingsAt(const Eigen::Vector2d& position) const {
    const Facet& facet = patch_.facetOf(position);
    return facet.window.reach() + reach_ * facet.by_pixel.cwiseAbs().rowwise().sum();
  }

  void sortBlock(const Box& block, const NodeColumn& left, const NodeColumn& middle,
                 const NodeColumn& right) {
    if (!left || !middle || !right) return sortOneByOne(block);
    std::array<Parabola, 3> along_rows;
    for (std::size_t i = 0; i < along_rows.size(); ++i) {
      along_rows[i] = Parabola::through((*left)[i], (*middle)[i], (*right)[i]);
    }
    const auto along_columns = [&along_rows](const auto& part) {
      return Parabola::through(part(along_rows[0]), part(along_rows[1]), part(along_rows[2]));
    };
    const Parabola constant = along_columns([](const Parabola& p) { return p.constant; });
    const Parabola linear = along_columns([](const Parabola& p) { return p.linear; });
    const Parabola quadratic = along_columns([](const Parabola& p) { return p.quadratic; });
    const Eigen::Vector2d surroundings = surroundingsAt(along_rows[1].at(1.0));
    const Eigen::Vector2d scale = 2.0 * block_.cast<double>().cwiseInverse();
    for (int row = block.top; row <= block.bottom; row += step_.y()) {
      const double down = scale.y() * (row - block.top);
      const Parabola along_row{constant.at(down), linear.at(down), quadratic.at(down)};
      for (int column = block.left; column <= block.right; column += step_.x()) {
        add(column, row, along_row.at(scale.x() * (column - block.left)), surroundings);
      }
    }
  }

  void sortOneByOne(const Box& block) {
    for (int row = block.top; row <= block.bottom; row += step_.y()) {
      for (int column = block.left; column <= block.right; column += step_.x()) {
        const auto position = positionAt(column, row);
        if (position) add(column, row, *position, surroundingsAt(*position));
      }
    }
  }

  void add(int column, int row, const Eigen::Vector2d& position,
           const Eigen::Vector2d& surroundings) {
    const Eigen::Vector2d low = position - surroundings;
    const Eigen::Vector2d high = position + surroundings;
    const TagPattern& pattern = patch_.pattern_;
    if (high.minCoeff() < 0.0 || low.maxCoeff() > static_cast<double>(pattern.width())) return;
    const bool is_even = tells_apart_ && pattern.isEven(low, high);
    (is_even ? on_even_ground_ : at_edges_).push_back({column, row, position});
  }

  const MarkerPatch& patch_;
  DrawingPlane plane_;
  Eigen::Vector2i step_;
  /// Pixels along columns and rows.
  Eigen::Vector2i block_;
  double reach_;
  bool tells_apart_;
  std::vector<Place> at_edges_;
  std::vector<Place> on_even_ground_;
};

void MarkerPatch::choosePlaces(const Pose2& map_from_base, const Box& box, const Choice& choice) {
  Sorter sorter(*this, map_from_base, box, choice);
  sorter.sort(box);
  places_.reserve(std::min(sorter.atEdges().size(), choice.max_at_edges) +
                  std::min(sorter.onEvenGround().size(), choice.max_on_even_ground));
  keep(sorter.atEdges(), choice.max_at_edges);
  keep(sorter.onEvenGround(), choice.max_on_even_ground);
}

void MarkerPatch::keep(const std::vector<Place>& places, std::size_t at_most) {
  if (at_most == 0) return;
  const std::size_t every =
      std::max<std::size_t>(1, places.size() / at_most + (places.size() % at_most != 0 ? 1 : 0));
  for (std::size_t i = 0; i < places.size(); i += every) places_.push_back(places[i]);
}

inline const Facet* MarkerPatch::facetWithinDrawing(const Eigen::Vector2d& position) const {
  const Facet& facet = facetOf(position);
  const Eigen::Vector2d& reach = facet.window.reach();
  const double width = pattern_.width();
  const bool is_within = facet.is_visible && (position - reach).minCoeff() >= 0.0 &&
                         (position + reach).maxCoeff() <= width;
  return is_within ? &facet : nullptr;
}

inline MarkerPixel MarkerPatch::pixelAt(const cv::Mat& panorama, const Place& place,
                                        const Facet& facet) const {
  const TagPattern::White white = pattern_.averageOver(place.position, facet.window);
  MarkerPixel pixel;
  pixel.column = place.column;
  pixel.row = place.row;
  pixel.grey = panorama.ptr<std::uint8_t>(place.row)[place.column];
  pixel.white = white.share;
  pixel.gradient = (white.by_position.transpose() * facet.by_pixel).norm();
  pixel.position = place.position / pattern_.width() - Eigen::Vector2d(0.5, 0.5);
  pixel.white_by_pose = white.by_position.transpose() * facet.by_pose;
  return pixel;
}

std::vector<Footprint> MarkerPatch::footprints() const {
  std::vector<Footprint> footprints;
  footprints.reserve(places_.size());
  for (const Place& place : places_) {
    const Facet* const facet = facetWithinDrawing(place.position);
    if (facet != nullptr) footprints.push_back({place.column, place.row, place.position, facet});
  }
  return footprints;
}

std::vector<MarkerPixel> MarkerPatch::pixels(const cv::Mat& panorama) const {
  std::vector<MarkerPixel> pixels;
  pixels.reserve(places_.size());
  for (const Place& place : places_) {
    const Facet* const facet = facetWithinDrawing(place.position);
    if (facet != nullptr) pixels.push_back(pixelAt(panorama, place, *facet));
  }
  return pixels;
}

LinesOfSight MarkerPatch::linesOfSight() const {
  LinesOfSight lines;
  lines.reserve(places_.size());
  for (const Place& place : places_) {
    lines.push_back(camera_.tabulatedRayInBase({place.column, place.row}));
  }
  return lines;
}

std::vector<MarkerPixel> MarkerPatch::pixels(const cv::Mat& panorama, const LinesOfSight& lines,
                                             const Pose2& map_from_base) const {
  const DrawingPlane plane(marker_, pattern_, map_from_base);
  std::vector<MarkerPixel> pixels;
  pixels.reserve(places_.size());
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const auto position = lines[i] ? plane.meet(*lines[i]) : std::nullopt;
    const Facet* const facet = position ? facetWithinDrawing(*position) : nullptr;
    if (facet == nullptr) continue;
    pixels.push_back(pixelAt(panorama, {places_[i].column, places_[i].row, *position}, *facet));
  }
  return pixels;
}

Eigen::Vector3d MarkerPatch::inMap(const Eigen::Vector2d& position) const {
  const double half = 0.5 * pattern_.width();
  return marker_.map_from_marker *
         (metres_per_module_ * Eigen::Vector3d(position.x() - half, half - position.y(), 0.0));
}

}  // namespace omnitag
