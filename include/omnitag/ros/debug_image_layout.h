#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

/// Where things stand in the debug image: a title, below it a square of cells whose inner ones the
/// panorama fills and whose outer ones hold the views.
namespace omnitag::debug_layout {

constexpr int kCell = 170;
constexpr int kCellsPerSide = 6;
constexpr int kTitleHeight = 44;
constexpr int kSide = kCell * kCellsPerSide;
constexpr int kSlots = 4 * (kCellsPerSide - 1);

/// The square that the panorama fills.
cv::Rect middle();

/// A cell of the border for each direction (rad in the image, from u toward v), in the directions'
/// cyclic order, so that lines from the middle do not cross; at most kSlots directions.
std::vector<cv::Rect> cellsFor(const std::vector<double>& directions);

}  // namespace omnitag::debug_layout
