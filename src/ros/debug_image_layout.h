#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

/// The layout of the debug image: a title and, below it, a square of cells. The panorama fills the
/// inner cells; the outer ones hold the views.
namespace omnitag::debug_layout {

constexpr int kCell = 170;
constexpr int kCellsPerSide = 6;
constexpr int kTitleHeight = 44;
constexpr int kSide = kCell * kCellsPerSide;
constexpr int kSlots = 4 * (kCellsPerSide - 1);

/// The square that the panorama fills.
cv::Rect middle();

/// A cell of the border for each direction (rad in the image, from u toward v), in the cyclic order
/// of the directions, so that lines from the middle do not cross. At most kSlots directions.
std::vector<cv::Rect> cellsFor(const std::vector<double>& directions);

}  // namespace omnitag::debug_layout
