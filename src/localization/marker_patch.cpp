#include "omnitag/localization/marker_patch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace omnitag {
namespace {

/// Pixels.
constexpr std::size_t kMostReserved = 2000;

/// Of a grid with so many columns, row by row.
std::size_t gridIndex(int column, int row, int columns) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
         static_cast<std::size_t>(column);
}

}  // namespace

class MarkerPatch::Plane {
 public:
  Plane(const MarkerPatch& patch, const Pose2& map_from_base)
      : half_(0.5 * patch.pattern_.width()),
        map_from_base_(Eigen::AngleAxisd(map_from_base.yaw, Eigen::Vector3d::UnitZ())) {
    // The drawing's y runs down.
    const double modules_per_metre = 1.0 / patch.metres_per_module_;
    const Eigen::Vector3d scale(modules_per_metre, -modules_per_metre, 1.0);
    const Eigen::Isometry3d marker_from_map = patch.marker_.map_from_marker.inverse();
    drawing_from_map_ = scale.asDiagonal() * marker_from_map.linear();
    drawing_from_base_ = drawing_from_map_ * map_from_base_;
    translation_ = scale.cwiseProduct(marker_from_map *
                                      Eigen::Vector3d(map_from_base.x, map_from_base.y, 0.0));
  }

  /// Where a line of sight meets the drawing, in modules, at its front.
  std::optional<Eigen::Vector2d> meet(const Ray& in_base) const {
    const Eigen::Vector3d origin = drawing_from_base_ * in_base.origin + translation_;
    const Eigen::Vector3d direction = drawing_from_base_ * in_base.direction;
    if (origin.z() <= 0.0 || direction.z() >= 0.0) return std::nullopt;
    const double range = -origin.z() / direction.z();
    return Eigen::Vector2d(half_ + origin.x() + range * direction.x(),
                           half_ + origin.y() + range * direction.y());
  }

  /// Derivative of meet() by the pose of the base (x, y, yaw): what is seen moves as the line of
  /// sight does, which moves with the base, and along it back to the drawing.
  Eigen::Matrix<double, 2, 3> derivative(const Ray& in_base) const {
    const Eigen::Vector3d origin = drawing_from_base_ * in_base.origin + translation_;
    const Eigen::Vector3d direction = drawing_from_base_ * in_base.direction;
    const double range = -origin.z() / direction.z();
    const Eigen::Vector3d from_base = map_from_base_ * (in_base.origin + range * in_base.direction);
    Eigen::Matrix3d moved;
    moved << 1.0, 0.0, -from_base.y(), 0.0, 1.0, from_base.x(), 0.0, 0.0, 0.0;
    const Eigen::Matrix3d in_drawing = drawing_from_map_ * moved;
    return in_drawing.topRows<2>() -
           direction.head<2>() / direction.z() * in_drawing.bottomRows<1>();
  }

 private:
  double half_;
  Eigen::Matrix3d map_from_base_;
  Eigen::Matrix3d drawing_from_map_;
  Eigen::Matrix3d drawing_from_base_;
  Eigen::Vector3d translation_;
};

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
  chooseLinesOfSight(map_from_base, boundingBox(nodes), choice);
}

inline const Facet& MarkerPatch::facetOf(const Eigen::Vector2d& position) const {
  const double facets_per_module = static_cast<double>(facets_along_) / pattern_.width();
  const auto indexAlong = [&](double coordinate) {
    return std::clamp(static_cast<int>(coordinate * facets_per_module), 0, facets_along_ - 1);
  };
  return facets_[gridIndex(indexAlong(position.x()), indexAlong(position.y()), facets_along_)];
}

MarkerPatch::Nodes MarkerPatch::nodesAt(const Pose2& map_from_base) const {
  const double width = static_cast<double>(pattern_.width()) / facets_along_;
  Nodes nodes;
  nodes.reserve(gridIndex(0, facets_along_ + 1, facets_along_ + 1));
  for (int row = 0; row <= facets_along_; ++row) {
    for (int column = 0; column <= facets_along_; ++column) {
      nodes.push_back(camera_.pixelFromMap(map_from_base, inMap({width * column, width * row})));
    }
  }
  return nodes;
}

void MarkerPatch::setFacets(const Nodes& nodes, const Pose2& map_from_base, double blur) {
  const Plane plane(*this, map_from_base);
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
  Sorter(const MarkerPatch& patch, const Pose2& map_from_base, const Choice& choice)
      : patch_(patch),
        plane_(patch, map_from_base),
        step_(patch.gridSteps(choice.max_considered)),
        reach_(choice.reach) {
    const std::size_t most = std::min(choice.max_considered, kMostReserved);
    at_edges_.reserve(most);
    on_even_ground_.reserve(most);
  }

  void sort(const Box& box) {
    // Roughly, positions follow from those of nodes around them.
    const Eigen::Vector2i node_step = 8 * step_;
    for (int top = box.top; top <= box.bottom; top += node_step.y()) {
      const int below = top + node_step.y();
      auto upper_left = positionAt(box.left, top);
      auto lower_left = positionAt(box.left, below);
      for (int left = box.left; left <= box.right; left += node_step.x()) {
        const int beyond = left + node_step.x();
        const auto upper_right = positionAt(beyond, top);
        const auto lower_right = positionAt(beyond, below);
        const Box block{left, top, std::min(beyond - 1, box.right),
                        std::min(below - 1, box.bottom)};
        if (upper_left && lower_left && upper_right && lower_right) {
          const Eigen::Vector2d right = (*upper_right - *upper_left) / node_step.x();
          const Eigen::Vector2d down = (*lower_left - *upper_left) / node_step.y();
          const Eigen::Vector2d twist =
              ((*lower_right - *lower_left) / node_step.x() - right) / node_step.y();
          sortBlock(block, *upper_left, right, down, twist);
        } else {
          sortOneByOne(block);
        }
        upper_left = upper_right;
        lower_left = lower_right;
      }
    }
  }

  const std::vector<Pixel>& atEdges() const { return at_edges_; }
  const std::vector<Pixel>& onEvenGround() const { return on_even_ground_; }

 private:
  std::optional<Eigen::Vector2d> positionAt(int column, int row) const {
    const std::optional<Ray> ray = patch_.camera_.tabulatedRayInBase({column, row});
    return ray ? plane_.meet(*ray) : std::nullopt;
  }

  /// Modules around a position that a pixel there may turn out to see.
  Eigen::Vector2d surroundingsAt(const Eigen::Vector2d& position) const {
    const Facet& facet = patch_.facetOf(position);
    return facet.window.reach() + reach_ * facet.by_pixel.cwiseAbs().rowwise().sum();
  }

  /// A block of pixels by the position of its first one, and how that changes along columns, along
  /// rows, and along both.
  void sortBlock(const Box& block, const Eigen::Vector2d& first, const Eigen::Vector2d& right,
                 const Eigen::Vector2d& down, const Eigen::Vector2d& twist) {
    const double width = block.right - block.left;
    const double height = block.bottom - block.top;
    const Eigen::Vector2d surroundings = surroundingsAt(
        first + 0.5 * width * right + 0.5 * height * down + 0.25 * width * height * twist);
    for (int row = block.top; row <= block.bottom; row += step_.y()) {
      const double below = row - block.top;
      const Eigen::Vector2d start = first + below * down;
      const Eigen::Vector2d by_column = right + below * twist;
      for (int column = block.left; column <= block.right; column += step_.x()) {
        add(column, row, start + (column - block.left) * by_column, surroundings);
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
    Pixel& pixel = (pattern.isEven(low, high) ? on_even_ground_ : at_edges_).emplace_back();
    pixel.column = column;
    pixel.row = row;
  }

  const MarkerPatch& patch_;
  Plane plane_;
  Eigen::Vector2i step_;
  double reach_;
  std::vector<Pixel> at_edges_;
  std::vector<Pixel> on_even_ground_;
};

void MarkerPatch::chooseLinesOfSight(const Pose2& map_from_base, const Box& box,
                                     const Choice& choice) {
  Sorter sorter(*this, map_from_base, choice);
  sorter.sort(box);
  lines_of_sight_.reserve(std::min(sorter.atEdges().size(), choice.max_at_edges) +
                          std::min(sorter.onEvenGround().size(), choice.max_on_even_ground));
  keep(sorter.atEdges(), choice.max_at_edges);
  keep(sorter.onEvenGround(), choice.max_on_even_ground);
}

void MarkerPatch::keep(const std::vector<Pixel>& pixels, std::size_t at_most) {
  if (at_most == 0) return;
  const std::size_t every =
      std::max<std::size_t>(1, pixels.size() / at_most + (pixels.size() % at_most != 0 ? 1 : 0));
  for (std::size_t i = 0; i < pixels.size(); i += every) {
    const auto ray = camera_.tabulatedRayInBase({pixels[i].column, pixels[i].row});
    if (ray) lines_of_sight_.push_back({pixels[i], *ray});
  }
}

template <typename Visit>
void MarkerPatch::visit(const Pose2& map_from_base, const Visit& visit) const {
  const Plane plane(*this, map_from_base);
  const double width = pattern_.width();
  for (const LineOfSight& line : lines_of_sight_) {
    const auto position = plane.meet(line.in_base);
    if (!position) continue;
    const Facet& facet = facetOf(*position);
    if (!facet.is_visible) continue;
    const Eigen::Vector2d& reach = facet.window.reach();
    if ((*position - reach).minCoeff() < 0.0 || (*position + reach).maxCoeff() > width) continue;
    visit(line, *position, facet);
  }
}

std::vector<Footprint> MarkerPatch::footprints(const Pose2& map_from_base) const {
  std::vector<Footprint> footprints;
  footprints.reserve(lines_of_sight_.size());
  visit(map_from_base,
        [&](const LineOfSight& line, const Eigen::Vector2d& position, const Facet& facet) {
          footprints.push_back({line.pixel.column, line.pixel.row, position, &facet});
        });
  return footprints;
}

std::vector<MarkerPixel> MarkerPatch::pixels(const cv::Mat& panorama,
                                             const Pose2& map_from_base) const {
  const double scale = 1.0 / pattern_.width();
  std::vector<MarkerPixel> pixels;
  pixels.reserve(lines_of_sight_.size());
  visit(map_from_base,
        [&](const LineOfSight& line, const Eigen::Vector2d& position, const Facet& facet) {
          const TagPattern::White white = pattern_.averageOver(position, facet.window);
          MarkerPixel& pixel = pixels.emplace_back();
          pixel.column = line.pixel.column;
          pixel.row = line.pixel.row;
          pixel.grey = panorama.ptr<std::uint8_t>(pixel.row)[pixel.column];
          pixel.white = white.share;
          pixel.gradient = (white.by_position.transpose() * facet.by_pixel).norm();
          pixel.position = scale * position - Eigen::Vector2d(0.5, 0.5);
          pixel.white_by_pose = white.by_position.transpose() * facet.by_pose;
        });
  return pixels;
}

Eigen::Vector3d MarkerPatch::inMap(const Eigen::Vector2d& position) const {
  const double half = 0.5 * pattern_.width();
  return marker_.map_from_marker *
         (metres_per_module_ * Eigen::Vector3d(position.x() - half, half - position.y(), 0.0));
}

}  // namespace omnitag
