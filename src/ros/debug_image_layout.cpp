#include "ros/debug_image_layout.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "omnitag/common/angle.h"

namespace omnitag::debug_layout {
namespace {

/// The border's cells in the order of their directions from the middle.
std::vector<cv::Rect> slots() {
  std::vector<cv::Rect> cells;
  for (int row = 0; row < kCellsPerSide; ++row) {
    for (int column = 0; column < kCellsPerSide; ++column) {
      const bool is_border =
          row == 0 || column == 0 || row == kCellsPerSide - 1 || column == kCellsPerSide - 1;
      if (is_border) {
        cells.emplace_back(column * kCell, kTitleHeight + row * kCell, kCell, kCell);
      }
    }
  }
  return cells;
}

double directionOf(const cv::Rect& cell) {
  const double center = kSide / 2.0;
  return std::atan2(cell.y - kTitleHeight + kCell / 2.0 - center, cell.x + kCell / 2.0 - center);
}

}  // namespace

cv::Rect middle() { return {kCell, kTitleHeight + kCell, kSide - 2 * kCell, kSide - 2 * kCell}; }

std::vector<cv::Rect> cellsFor(const std::vector<double>& directions) {
  if (directions.empty()) return {};
  std::vector<cv::Rect> cells = slots();
  std::sort(cells.begin(), cells.end(),
            [](const cv::Rect& a, const cv::Rect& b) { return directionOf(a) < directionOf(b); });
  std::vector<std::size_t> order(directions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&directions](std::size_t a, std::size_t b) {
    return normalizeAngle(directions[a]) < normalizeAngle(directions[b]);
  });

  // The nearest slot for each. Those that share a slot are then pushed apart, first onward, then
  // back from where the last one meets the first.
  std::vector<int> slot;
  for (const std::size_t i : order) {
    const auto distance = [&](const cv::Rect& cell) {
      return std::abs(normalizeAngle(directionOf(cell) - directions[i]));
    };
    const auto nearest = std::min_element(
        cells.begin(), cells.end(),
        [&](const cv::Rect& a, const cv::Rect& b) { return distance(a) < distance(b); });
    const int wanted = static_cast<int>(nearest - cells.begin());
    slot.push_back(slot.empty() ? wanted : std::max(wanted, slot.back() + 1));
  }
  int limit = slot.front() + kSlots;
  for (auto it = slot.rbegin(); it != slot.rend(); ++it) {
    *it = std::min(*it, limit - 1);
    limit = *it;
  }

  std::vector<cv::Rect> chosen(directions.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    chosen[order[k]] = cells[static_cast<std::size_t>((slot[k] + kSlots) % kSlots)];
  }
  return chosen;
}

}  // namespace omnitag::debug_layout
