#include "omnitag/marker/tag_pattern.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "apriltag_family.h"
#include "omnitag/common/error.h"

namespace omnitag {

TagPattern::TagPattern(const std::string& family, int id) {
  const AprilTagFamily tags = createAprilTagFamily(family);
  const int count = static_cast<int>(tags->ncodes);
  if (id < 0 || id >= count) {
    throw InputError(family + ": expected an id from 0 to " + std::to_string(count - 1) +
                     ", found " + std::to_string(id));
  }
  width_ = tags->total_width;
  width_between_corners_ = tags->width_at_border;
  // The library does not export what frees its images, which it has from malloc.
  using Free = void (*)(void*);
  const std::unique_ptr<image_u8_t, Free> image(apriltag_to_image(tags.get(), id), std::free);
  const std::unique_ptr<std::uint8_t, Free> pixels(image->buf, std::free);
  sums_.assign(indexOf(width_, width_) + 1, 0.0);
  for (int row = 0; row < width_; ++row) {
    for (int column = 0; column < width_; ++column) {
      const double white = pixels.get()[row * image->stride + column] > 127 ? 1.0 : 0.0;
      sums_[indexOf(column + 1, row + 1)] = white + sums_[indexOf(column, row + 1)] +
                                            sums_[indexOf(column + 1, row)] -
                                            sums_[indexOf(column, row)];
    }
  }
}

double TagPattern::sumAt(int column, int row) const { return sums_[indexOf(column, row)]; }

bool TagPattern::isWhite(int column, int row) const {
  return sumAt(column + 1, row + 1) - sumAt(column, row + 1) - sumAt(column + 1, row) +
             sumAt(column, row) >
         0.5;
}

TagPattern::Area TagPattern::whiteAbove(double x, double y) const {
  const int column = std::clamp(static_cast<int>(x), 0, width_ - 1);
  const int row = std::clamp(static_cast<int>(y), 0, width_ - 1);
  const double a = x - column;
  const double b = y - row;
  // Within a module the area grows bilinearly, since the module is all black or all white.
  const double upper_left = sumAt(column, row);
  const double right = sumAt(column + 1, row) - upper_left;
  const double down = sumAt(column, row + 1) - upper_left;
  const double across = sumAt(column + 1, row + 1) - upper_left - right - down;
  return {upper_left + a * right + b * down + a * b * across, right + b * across,
          down + a * across};
}

TagPattern::White TagPattern::average(const Eigen::Vector2d& position,
                                      const Eigen::Vector2d& size) const {
  const Eigen::Vector2d low = position - 0.5 * size;
  const Eigen::Vector2d high = position + 0.5 * size;
  const Area a = whiteAbove(low.x(), low.y());
  const Area b = whiteAbove(high.x(), low.y());
  const Area c = whiteAbove(low.x(), high.y());
  const Area d = whiteAbove(high.x(), high.y());
  const double scale = 1.0 / (size.x() * size.y());
  White white;
  white.share = scale * (d.area - b.area - c.area + a.area);
  white.by_position =
      scale * Eigen::Vector2d(d.by_x - b.by_x - c.by_x + a.by_x, d.by_y - b.by_y - c.by_y + a.by_y);
  return white;
}

}  // namespace omnitag
