#include "omnitag/marker/tag_pattern.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "apriltag_family.h"
#include "omnitag/common/error.h"
#include "omnitag/common/normal_distribution.h"

namespace omnitag {
namespace {

bool isWithinModule(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  return static_cast<int>(low.x()) == static_cast<int>(high.x()) &&
         static_cast<int>(low.y()) == static_cast<int>(high.y());
}

}  // namespace

TagPattern::Window::Window(const Eigen::Vector2d& side_u, const Eigen::Vector2d& side_v,
                           double blur_variance, const Eigen::Vector2d& sweep) {
  // Pixels squared. A smaller variance only makes the pixel a little larger.
  constexpr double kSharp = 0.05;
  constexpr double kVarianceOfPixel = 1.0 / 12.0;  // along either side
  const double variance = kVarianceOfPixel + blur_variance;
  const double width = std::sqrt(variance / kVarianceOfPixel);
  const double side = width * std::min(side_u.norm(), side_v.norm());
  const double steps_needed = std::ceil(2.0 * sweep.norm() / side);
  constexpr double kMostSteps = 8.0;
  steps_ = static_cast<int>(std::clamp(steps_needed, 1.0, kMostSteps));
  step_ = sweep / steps_;
  const Eigen::Vector2d squares = side_u.cwiseAbs2() + side_v.cwiseAbs2();
  is_blurred_ = blur_variance >= kSharp;
  if (is_blurred_) {
    const double mixed = variance * (side_u.x() * side_u.y() + side_v.x() * side_v.y());
    const Eigen::Vector2d variances = variance * squares;
    const double correlation = mixed / std::sqrt(variances.prod());
    Eigen::Vector2d line = (std::abs(correlation) * variances).cwiseSqrt();
    if (mixed < 0.0) line.y() = -line.y();
    // Gauss-Hermite rules with three and with five points. The Gaussian at each point must be wide
    // enough to fill the gap to the next.
    constexpr double kStrong = 0.35;
    add(Eigen::Vector2d::Zero(), std::abs(correlation) < kStrong ? 2.0 / 3.0 : 8.0 / 15.0);
    const auto addBeside = [&](double deviations, double share) {
      add(-deviations * line, share);
      add(deviations * line, share);
    };
    if (std::abs(correlation) < kStrong) {
      addBeside(std::sqrt(3.0), 1.0 / 6.0);
    } else {
      addBeside(std::sqrt(5.0 - std::sqrt(10.0)), (7.0 + 2.0 * std::sqrt(10.0)) / 60.0);
      addBeside(std::sqrt(5.0 + std::sqrt(10.0)), (7.0 - 2.0 * std::sqrt(10.0)) / 60.0);
    }
    // Each step also includes the sweep within it.
    extent_ = ((1.0 - std::abs(correlation)) * variances + step_.cwiseAbs2() / 12.0).cwiseSqrt();
    constexpr double kMostOfIt = 3.0;
    constexpr double kNearlyAllOfIt = 1.75;
    const Eigen::Vector2d deviations = variances.cwiseSqrt();
    reach_ = kMostOfIt * deviations + 0.5 * sweep.cwiseAbs();
    core_ = kNearlyAllOfIt * deviations + 0.5 * sweep.cwiseAbs();
  } else {
    const Eigen::Vector2d sum = 0.25 * width * (side_u + side_v);
    const Eigen::Vector2d difference = 0.25 * width * (side_u - side_v);
    for (const Eigen::Vector2d& place : {sum, difference}) {
      add(-place, 0.25);
      add(place, 0.25);
    }
    extent_ = 0.5 * (0.25 * width * width * squares + step_.cwiseAbs2()).cwiseSqrt();
    reach_ = 0.5 * (width * (side_u.cwiseAbs() + side_v.cwiseAbs()) + sweep.cwiseAbs());
    core_ = reach_;
  }
  size_ = (width * width * squares + sweep.cwiseAbs2()).cwiseSqrt();
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
  // The library does not export the function that frees its images, which come from malloc. Drawing
  // does not change the family.
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
    return {isWhiteAt(position) ? 1.0 : 0.0, Eigen::Vector2d::Zero()};
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
  const Profile columns = profileOf(middle.x(), deviations.x());
  const Profile rows = profileOf(middle.y(), deviations.y());
  White white;
  for (int r = 0; r < rows.count; ++r) {
    double of_row = 0.0;
    double slope_of_row = 0.0;
    const char* const modules = &is_white_[moduleIndex(columns.first, rows.first + r)];
    for (int c = 0; c < columns.count; ++c) {
      if (modules[c] == 0) continue;
      of_row += columns.shares[static_cast<std::size_t>(c)];
      slope_of_row += columns.slopes[static_cast<std::size_t>(c)];
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
