#include "omnitag/marker/tag_pattern.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "apriltag_family.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

bool isWithinModule(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  return static_cast<int>(low.x()) == static_cast<int>(high.x()) &&
         static_cast<int>(low.y()) == static_cast<int>(high.y());
}

}  // namespace

TagPattern::Window::Window(const Eigen::Vector2d& side_u, const Eigen::Vector2d& side_v)
    : reach_(0.5 * (side_u.cwiseAbs() + side_v.cwiseAbs())),
      size_((side_u.cwiseAbs2() + side_v.cwiseAbs2()).cwiseSqrt()) {
  const Eigen::Vector2d sum = 0.25 * (side_u + side_v);
  const Eigen::Vector2d difference = 0.25 * (side_u - side_v);
  parts_ = {-sum, -difference, difference, sum};
  per_area_of_part_ = 4.0 / size_.prod();
}

TagPattern::TagPattern(const std::string& family, int id)
    : TagPattern(*createAprilTagFamily(family), id) {}

TagPattern::TagPattern(const apriltag_family& family, int id) {
  const int count = static_cast<int>(family.ncodes);
  if (id < 0 || id >= count) {
    throw InputError(std::string(family.name) + ": expected an id from 0 to " +
                     std::to_string(count - 1) + ", found " + std::to_string(id));
  }
  width_ = family.total_width;
  width_between_corners_ = family.width_at_border;
  // The library does not export what frees its images, which it has from malloc. It draws without
  // changing the family.
  using Free = void (*)(void*);
  const std::unique_ptr<image_u8_t, Free> image(
      apriltag_to_image(const_cast<apriltag_family_t*>(&family), id), std::free);
  const std::unique_ptr<std::uint8_t, Free> pixels(image->buf, std::free);
  sums_.assign(cornerIndex(width_, width_) + 1, 0.0);
  for (int row = 0; row < width_; ++row) {
    for (int column = 0; column < width_; ++column) {
      const double white = pixels.get()[row * image->stride + column] > 127 ? 1.0 : 0.0;
      is_white_.push_back(white > 0.5 ? 1 : 0);
      sums_[cornerIndex(column + 1, row + 1)] = white + sums_[cornerIndex(column, row + 1)] +
                                                sums_[cornerIndex(column + 1, row)] -
                                                sums_[cornerIndex(column, row)];
    }
  }

  compareNeighbours();

  data_modules_ = static_cast<int>(family.nbits);
  data_module_.assign(is_white_.size(), -1);
  const int border = (width_ - width_between_corners_) / 2;
  for (int bit = 0; bit < data_modules_; ++bit) {
    const int column = border + static_cast<int>(family.bit_x[bit]);
    const int row = border + static_cast<int>(family.bit_y[bit]);
    data_module_[moduleIndex(column, row)] = bit;
    is_data_white_.push_back(is_white_[moduleIndex(column, row)]);
  }
}

void TagPattern::compareNeighbours() {
  const auto colourOf = [this](int column, int row) {
    return isWhite(std::clamp(column, 0, width_ - 1), std::clamp(row, 0, width_ - 1));
  };
  for (int row = -1; row <= width_; ++row) {
    for (int column = -1; column <= width_; ++column) {
      unsigned unlike = 0;
      for (int neighbour = 0; neighbour < 9; ++neighbour) {
        const bool is_like =
            colourOf(column + neighbour % 3 - 1, row + neighbour / 3 - 1) == colourOf(column, row);
        unlike |= is_like ? 0U : 1U << neighbour;
      }
      unlike_neighbours_.push_back(static_cast<std::uint16_t>(unlike));
    }
  }
}

bool TagPattern::isWhite(int column, int row) const {
  return is_white_[moduleIndex(column, row)] != 0;
}

bool TagPattern::isWhiteAt(const Eigen::Vector2d& position) const {
  return isWhite(moduleAt(position.x()), moduleAt(position.y()));
}

TagPattern::Place TagPattern::placeOf(double coordinate) const {
  const int module = moduleAt(coordinate);
  return {module, coordinate - module};
}

TagPattern::Area TagPattern::whiteAbove(const Place& x, const Place& y) const {
  // Within a module the area grows bilinearly, since the module is all black or all white.
  const double* const upper = &sums_[cornerIndex(x.module, y.module)];
  const double* const lower = upper + width_ + 1;
  const double right = upper[1] - upper[0];
  const double down = lower[0] - upper[0];
  const double across = lower[1] - lower[0] - right;
  const double by_x = right + y.within * across;
  return {upper[0] + x.within * by_x + y.within * down, by_x, down + x.within * across};
}

inline TagPattern::White TagPattern::averageBetween(const Eigen::Vector2d& low,
                                                    const Eigen::Vector2d& high,
                                                    double per_area) const {
  if (isWithinModule(low, high)) return {isWhiteAt(low) ? 1.0 : 0.0, Eigen::Vector2d::Zero()};
  const Place left = placeOf(low.x());
  const Place right = placeOf(high.x());
  const Place top = placeOf(low.y());
  const Place bottom = placeOf(high.y());
  const Area a = whiteAbove(left, top);
  const Area b = whiteAbove(right, top);
  const Area c = whiteAbove(left, bottom);
  const Area d = whiteAbove(right, bottom);
  return {per_area * (d.area - b.area - c.area + a.area),
          per_area * Eigen::Vector2d(d.by_x - b.by_x - c.by_x + a.by_x,
                                     d.by_y - b.by_y - c.by_y + a.by_y)};
}

TagPattern::White TagPattern::average(const Eigen::Vector2d& position,
                                      const Eigen::Vector2d& size) const {
  return averageBetween(position - 0.5 * size, position + 0.5 * size, 1.0 / size.prod());
}

void TagPattern::appendDataShares(const Eigen::Vector2d& position, const Eigen::Vector2d& size,
                                  std::vector<DataShare>* shares) const {
  const Eigen::Vector2d low = (position - 0.5 * size).cwiseMax(0.0);
  const Eigen::Vector2d high = (position + 0.5 * size).cwiseMin(width_);
  const auto overlap = [&low, &high](int module, int axis) {
    return std::min(high[axis], module + 1.0) - std::max(low[axis], static_cast<double>(module));
  };
  const double scale = 1.0 / size.prod();
  for (int row = static_cast<int>(low.y()); row < high.y(); ++row) {
    const double share_of_row = scale * overlap(row, 1);
    for (int column = static_cast<int>(low.x()); column < high.x(); ++column) {
      const int module = data_module_[moduleIndex(column, row)];
      if (module >= 0) shares->push_back({module, share_of_row * overlap(column, 0)});
    }
  }
}

TagPattern::White TagPattern::averageOver(const Eigen::Vector2d& position,
                                          const Window& window) const {
  if (isWithinModule(position - window.reach_, position + window.reach_)) {
    return {isWhiteAt(position) ? 1.0 : 0.0, Eigen::Vector2d::Zero()};
  }
  const Eigen::Vector2d half = 0.25 * window.size_;
  White white;
  for (const Eigen::Vector2d& part : window.parts_) {
    const Eigen::Vector2d middle = position + part;
    const White of_part = averageBetween(middle - half, middle + half, window.per_area_of_part_);
    white.share += 0.25 * of_part.share;
    white.by_position += 0.25 * of_part.by_position;
  }
  return white;
}

void TagPatterns::add(const MarkerMap& map) {
  std::map<std::string, AprilTagFamily> families;
  for (const Marker& marker : map.markers) {
    const auto key = std::make_pair(marker.family, marker.id);
    if (patterns_.count(key) > 0) continue;
    auto family = families.find(marker.family);
    if (family == families.end()) {
      family = families.emplace(marker.family, createAprilTagFamily(marker.family)).first;
    }
    patterns_.emplace(key, TagPattern(*family->second, marker.id));
  }
}

const TagPattern& TagPatterns::of(const Marker& marker) const {
  return patterns_.at({marker.family, marker.id});
}

}  // namespace omnitag
