#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>

namespace omnitag {

/// OpenCV draws at fractions of a pixel where it is told how many binary digits of them there are.
constexpr int kFractionalBits = 4;

/// A place of an image (pixels, the centre of the top-left pixel at (0, 0)) with that many digits.
cv::Point fixedPoint(const cv::Point2d& place);

/// Pixels that a line of text takes, above its baseline.
cv::Size sizeOfText(const std::string& text, double size);

/// Writes from the left, and returns where the text ends. `size`: of OpenCV's letters.
int writeText(const std::string& text, const cv::Point& baseline, const cv::Scalar& color,
              double size, cv::Mat* image);

}  // namespace omnitag
