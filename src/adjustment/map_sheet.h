#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>

#include "adjustment/error_ellipse.h"

namespace omnitag {

/// A sheet of paper over a part of the floor, to draw on in the map's coordinates (m). Colours are
/// B, G, R; widths are in pixels.
class MapSheet {
 public:
  /// The part from the corner `low` to `high`, 1100 pixels along its longer side, with a grid of
  /// metres.
  MapSheet(const Eigen::Vector2d& low, const Eigen::Vector2d& high);

  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const cv::Scalar& color, int width);
  void text(const Eigen::Vector2d& middle, const std::string& words, const cv::Scalar& color);
  void filledEllipse(const Eigen::Vector2d& centre, const ErrorEllipse& ellipse,
                     const cv::Scalar& color);
  void dashedEllipse(const Eigen::Vector2d& centre, const ErrorEllipse& ellipse,
                     const cv::Scalar& color);

  /// CV_8UC3.
  const cv::Mat& image() const { return image_; }

 private:
  void drawGrid();
  cv::Point2d position(const Eigen::Vector2d& point) const;

  Eigen::Vector2d low_;
  Eigen::Vector2d high_;
  /// Pixels per metre.
  double scale_ = 1.0;
  cv::Mat image_;
};

}  // namespace omnitag
