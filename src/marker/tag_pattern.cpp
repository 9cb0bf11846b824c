#include "marker/tag_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <opencv2/core.hpp>

#include "common/normal_distribution.h"
#include "marker/apriltag_family.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// Modules, largest standard deviation of a Gaussian that a Profile holds completely.
constexpr double kWidest = 3.9;

/// A wide Gaussian as rectangles side by side along each axis, in standard deviations.
class Boxes {
 public:
  static constexpr int kCount = 25;
  static constexpr double kWidth = 0.3;

  Boxes() {
    const auto below = [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); };
    double sum = 0.0;
    for (int i = 0; i < kCount; ++i) {
      const double share = below(middleOf(i) + 0.5 * kWidth) - below(middleOf(i) - 0.5 * kWidth);
      shares_[static_cast<std::size_t>(i)] = share;
      sum += share;
    }
    for (double& share : shares_) share /= sum;
  }

  /// Calls `visit` with the middle of each rectangle, from the Gaussian's, and its share.
  template <typename Visit>
  void visit(const Eigen::Vector2d& deviations, const Visit& visit) const {
    for (int row = 0; row < kCount; ++row) {
      for (int column = 0; column < kCount; ++column) {
        const Eigen::Vector2d from_middle(middleOf(column), middleOf(row));
        visit(deviations.cwiseProduct(from_middle), shareOf(column) * shareOf(row));
      }
    }
  }

 private:
  static constexpr int kMiddle = kCount / 2;
  static double middleOf(int i) { return kWidth * (i - kMiddle); }
  double shareOf(int i) const { return shares_[static_cast<std::size_t>(i)]; }

  std::array<double, kCount> shares_{};
};

const Boxes& boxes() {
  static const Boxes all;
  return all;
}

bool isWithinModule(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  return static_cast<int>(low.x()) == static_cast<int>(high.x()) &&
         static_cast<int>(low.y()) == static_cast<int>(high.y());
}

/// White around a picture's border that every sheet has, as a share of the edge.
constexpr double kQuietZone = 0.0625;

double borderCells(const PatternPicture& picture) {
  return picture.border * picture.side / (1.0 - 2.0 * picture.border);
}

/// The fewest modules per cell that make the border a whole number of modules, give or take a
/// hundredth of a cell or, at most, a twenty-fourth.
int modulesPerCell(const PatternPicture& picture) {
  constexpr double kTolerance = 0.01;
  constexpr int kMost = 12;
  for (int modules = 1; modules < kMost; ++modules) {
    const double border = modules * borderCells(picture);
    if (std::abs(border - std::round(border)) <= kTolerance * modules) return modules;
  }
  return kMost;
}

}  // namespace

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
  // The library does not export the function that frees its images, which come from malloc. Drawing
  // does not change the family.
  using Free = void (*)(void*);
  const std::unique_ptr<image_u8_t, Free> image(
      apriltag_to_image(const_cast<apriltag_family_t*>(&family), id), std::free);
  const std::unique_ptr<std::uint8_t, Free> pixels(image->buf, std::free);
  for (int row = 0; row < width_; ++row) {
    for (int column = 0; column < width_; ++column) {
      white_.push_back(pixels.get()[row * image->stride + column] > 127 ? 1.0 : 0.0);
    }
  }
  data_module_.assign(white_.size(), -1);
  const int border = (width_ - width_between_corners_) / 2;
  for (int bit = 0; bit < static_cast<int>(family.nbits); ++bit) {
    const int column = border + static_cast<int>(family.bit_x[bit]);
    const int row = border + static_cast<int>(family.bit_y[bit]);
    data_module_[moduleIndex(column, row)] = bit;
    data_.push_back(2.0 * whiteAt(column, row) - 1.0);
  }
  data_area_ = static_cast<double>(data_.size());
  prepare();
}

TagPattern::TagPattern(const PatternPicture& picture) {
  const int side = picture.side;
  const int per_cell = modulesPerCell(picture);
  const int border = cvRound(per_cell * borderCells(picture));
  const int inside = per_cell * side;
  width_between_corners_ = inside + 2 * border;
  const int quiet = std::max(1, cvRound(kQuietZone * width_between_corners_));
  width_ = width_between_corners_ + 2 * quiet;
  data_area_ = inside * inside;
  data_dimensions_ = dimensionsOf(picture);
  feature_width_ = std::min<double>(border, inside / std::sqrt(data_dimensions_));
  white_.assign(moduleIndex(0, width_), 1.0);
  data_module_.assign(white_.size(), -1);
  for (int row = quiet; row < width_ - quiet; ++row) {
    for (int column = quiet; column < width_ - quiet; ++column) {
      const int x = column - quiet - border;
      const int y = row - quiet - border;
      const bool is_inside = std::min(x, y) >= 0 && std::max(x, y) < inside;
      double& white = white_[moduleIndex(column, row)];
      white = is_inside ? picture.whiteAt(x / per_cell, y / per_cell) : 0.0;
      if (is_inside) data_module_[moduleIndex(column, row)] = y / per_cell * side + x / per_cell;
    }
  }
  for (const double white : picture.white) data_.push_back(2.0 * white - 1.0);
  prepare();
}

TagPattern::TagPattern(const Marker& marker)
    : TagPattern(marker.picture ? TagPattern(*marker.picture)
                                : TagPattern(marker.family, marker.id)) {}

void TagPattern::prepare() {
  sums_.assign(cornerIndex(width_, width_) + 1, 0.0);
  for (int row = 0; row < width_; ++row) {
    for (int column = 0; column < width_; ++column) {
      sums_[cornerIndex(column + 1, row + 1)] =
          whiteAt(column, row) + sums_[cornerIndex(column, row + 1)] +
          sums_[cornerIndex(column + 1, row)] - sums_[cornerIndex(column, row)];
    }
  }
  compareNeighbours();
}

void TagPattern::compareNeighbours() {
  // Neighbouring cells of a picture hardly ever have the very same grey.
  constexpr double kSame = 0.1;
  const auto whiteNear = [this](int column, int row) {
    return whiteAt(std::clamp(column, 0, width_ - 1), std::clamp(row, 0, width_ - 1));
  };
  for (int row = -1; row <= width_; ++row) {
    for (int column = -1; column <= width_; ++column) {
      unsigned unlike = 0;
      for (int neighbour = 0; neighbour < 9; ++neighbour) {
        const double difference =
            whiteNear(column + neighbour % 3 - 1, row + neighbour / 3 - 1) - whiteNear(column, row);
        const bool is_like = std::abs(difference) < kSame;
        unlike |= is_like ? 0U : 1U << neighbour;
      }
      unlike_neighbours_.push_back(static_cast<std::uint16_t>(unlike));
    }
  }
}

double TagPattern::whiteAt(const Eigen::Vector2d& position) const {
  return whiteAt(moduleAt(position.x()), moduleAt(position.y()));
}

TagPattern::Place TagPattern::placeOf(double coordinate) const {
  const int module = moduleAt(coordinate);
  return {module, coordinate - module};
}

TagPattern::Area TagPattern::whiteAbove(const Place& x, const Place& y) const {
  // Within a module, which is of one colour, the area grows bilinearly.
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
  if (isWithinModule(low, high)) return {whiteAt(low), Eigen::Vector2d::Zero()};
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

void TagPattern::appendDataShares(const Eigen::Vector2d& position, const Window& window,
                                  std::vector<DataShare>* shares) const {
  const auto first_share = static_cast<std::ptrdiff_t>(shares->size());
  const auto add = [&](int module, double share) {
    const auto found = std::find_if(shares->begin() + first_share, shares->end(),
                                    [module](const DataShare& s) { return s.module == module; });
    if (found == shares->end()) {
      shares->push_back({module, share});
    } else {
      found->share += share;
    }
  };
  const auto addRectangle = [&](const Eigen::Vector2d& middle, const Eigen::Vector2d& half,
                                double share) {
    const Eigen::Vector2d low = (middle - half).cwiseMax(0.0);
    const Eigen::Vector2d high = (middle + half).cwiseMin(width_);
    const auto overlap = [&low, &high](int module, int axis) {
      return std::min(high[axis], module + 1.0) - std::max(low[axis], static_cast<double>(module));
    };
    const double per_area = share / (4.0 * half.prod());
    for (int row = static_cast<int>(low.y()); row < high.y(); ++row) {
      const double share_of_row = per_area * overlap(row, 1);
      for (int column = static_cast<int>(low.x()); column < high.x(); ++column) {
        const int module = data_module_[moduleIndex(column, row)];
        if (module >= 0) add(module, share_of_row * overlap(column, 0));
      }
    }
  };
  if (!window.is_blurred_) {
    addRectangle(position, 0.5 * window.size_, 1.0);
    return;
  }
  window.visit(position, [&](const Eigen::Vector2d& middle, double share) {
    if (window.extent_.maxCoeff() > kWidest) {
      const Eigen::Vector2d half = 0.5 * Boxes::kWidth * window.extent_;
      boxes().visit(window.extent_, [&](const Eigen::Vector2d& from_middle, double of_box) {
        addRectangle(withinDrawing(middle + from_middle, half), half, share * of_box);
      });
      return;
    }
    const Profile columns = profileOf(middle.x(), window.extent_.x());
    const Profile rows = profileOf(middle.y(), window.extent_.y());
    for (int r = 0; r < rows.count; ++r) {
      const double share_of_row = share * rows.shares[static_cast<std::size_t>(r)];
      for (int c = 0; c < columns.count; ++c) {
        const int module = data_module_[moduleIndex(columns.first + c, rows.first + r)];
        if (module >= 0) add(module, share_of_row * columns.shares[static_cast<std::size_t>(c)]);
      }
    }
  });
}

TagPattern::White TagPattern::averageOver(const Eigen::Vector2d& position,
                                          const Window& window) const {
  if (isWithinModule(position - window.reach_, position + window.reach_)) {
    return {whiteAt(position), Eigen::Vector2d::Zero()};
  }
  const double per_area = 0.25 / window.extent_.prod();
  White white;
  window.visit(position, [&](const Eigen::Vector2d& middle, double share) {
    const White there = window.is_blurred_ ? averageOverGaussian(middle, window.extent_)
                                           : averageBetween(middle - window.extent_,
                                                            middle + window.extent_, per_area);
    white.share += share * there.share;
    white.by_position += share * there.by_position;
  });
  return white;
}

TagPattern::Profile TagPattern::profileOf(double middle, double deviation) const {
  const NormalDistribution& normal = NormalDistribution::tabulated();
  const double reach = NormalDistribution::kReach * deviation;
  const double per_deviation = 1.0 / deviation;
  Profile profile;
  profile.first = std::clamp(static_cast<int>(std::floor(middle - reach)), 0, width_ - 1);
  const int last = std::clamp(static_cast<int>(std::floor(middle + reach)), profile.first,
                              std::min(width_, profile.first + Profile::kMost) - 1);
  profile.count = last - profile.first + 1;
  // The first and the last module include what is beyond them.
  double below = 0.0;
  double slope_below = 0.0;
  for (int i = 0; i < profile.count; ++i) {
    const bool is_last = i == profile.count - 1;
    const auto [share, density] = is_last
                                      ? NormalDistribution::Value{1.0, 0.0}
                                      : normal.at((profile.first + i + 1 - middle) * per_deviation);
    const double slope = -density * per_deviation;
    profile.shares[static_cast<std::size_t>(i)] = share - below;
    profile.slopes[static_cast<std::size_t>(i)] = slope - slope_below;
    below = share;
    slope_below = slope;
  }
  return profile;
}

TagPattern::White TagPattern::averageOverGaussian(const Eigen::Vector2d& middle,
                                                  const Eigen::Vector2d& deviations) const {
  if (deviations.maxCoeff() > kWidest) {
    const Eigen::Vector2d half = 0.5 * Boxes::kWidth * deviations;
    const double per_area = 0.25 / half.prod();
    White white;
    boxes().visit(deviations, [&](const Eigen::Vector2d& from_middle, double share) {
      const Eigen::Vector2d there = withinDrawing(middle + from_middle, half);
      const White of_box = averageBetween(there - half, there + half, per_area);
      white.share += share * of_box.share;
      white.by_position += share * of_box.by_position;
    });
    return white;
  }
  const Profile columns = profileOf(middle.x(), deviations.x());
  const Profile rows = profileOf(middle.y(), deviations.y());
  White white;
  for (int r = 0; r < rows.count; ++r) {
    double of_row = 0.0;
    double slope_of_row = 0.0;
    const double* const modules = &white_[moduleIndex(columns.first, rows.first + r)];
    for (int c = 0; c < columns.count; ++c) {
      of_row += modules[c] * columns.shares[static_cast<std::size_t>(c)];
      slope_of_row += modules[c] * columns.slopes[static_cast<std::size_t>(c)];
    }
    const auto row = static_cast<std::size_t>(r);
    white.share += rows.shares[row] * of_row;
    white.by_position +=
        Eigen::Vector2d(rows.shares[row] * slope_of_row, rows.slopes[row] * of_row);
  }
  return white;
}

void TagPatterns::add(const MarkerMap& map) {
  std::map<std::string, AprilTagFamily> families;
  for (const Marker& marker : map.markers) {
    const auto key = std::make_pair(marker.family, marker.id);
    if (patterns_.count(key) > 0) continue;
    if (marker.picture) {
      patterns_.emplace(key, TagPattern(*marker.picture));
      continue;
    }
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
