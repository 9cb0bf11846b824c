#pragma once

#include <cmath>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

#include "planning/occupancy_grid.h"

namespace omnitag::test {

/// m, of the grids here.
constexpr double kCellSize = 0.05;

/// A grid file of cells of 5 cm whose lower left corner is here.
inline GridFile gridFileAt(double x, double y, double yaw = 0.0) {
  GridFile file;
  file.image = "grid.png";
  file.resolution = kCellSize;
  file.origin = {x, y, yaw};
  return file;
}

/// Draws a floor from above, in metres from the lower left corner of its image.
class FloorDrawing {
 public:
  FloorDrawing(double width, double height)
      : image_(cvRound(height / kCellSize), cvRound(width / kCellSize), CV_8UC1,
               cv::Scalar(kUnknown)) {}

  FloorDrawing& free(double x0, double y0, double x1, double y1) {
    return fill(x0, y0, x1, y1, 254.0);
  }
  FloorDrawing& occupied(double x0, double y0, double x1, double y1) {
    return fill(x0, y0, x1, y1, 0.0);
  }
  const cv::Mat& image() const { return image_; }

 private:
  static constexpr double kUnknown = 205.0;

  FloorDrawing& fill(double x0, double y0, double x1, double y1, double grey) {
    const int left = cvRound(x0 / kCellSize);
    const int right = cvRound(x1 / kCellSize);
    const int top = image_.rows - cvRound(y1 / kCellSize);
    const int bottom = image_.rows - cvRound(y0 / kCellSize);
    image_(cv::Range(top, bottom), cv::Range(left, right)).setTo(grey);
    return *this;
  }

  cv::Mat image_;
};

/// Two rooms of 4 x 4 m, from (-4, -2) to (4, 2) of the map, with a wall between them at x = 0,
/// 10 cm thick, and a door of 1 m in its middle.
inline OccupancyGrid twoRooms() {
  const FloorDrawing drawing = FloorDrawing(8.4, 4.4)
                                   .occupied(0.1, 0.1, 8.3, 4.3)
                                   .free(0.2, 0.2, 8.2, 4.2)
                                   .occupied(4.15, 0.2, 4.25, 1.7)
                                   .occupied(4.15, 2.7, 4.25, 4.2);
  return {drawing.image(), gridFileAt(-4.2, -2.2)};
}

}  // namespace omnitag::test
