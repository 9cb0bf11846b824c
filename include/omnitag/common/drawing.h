#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>

namespace omnitag {

/// The number of fractional binary digits of the coordinates that OpenCV's drawing functions take
/// (their `shift`).
constexpr int kFractionalBits = 4;

/// A position in an image (pixels, the centre of the top-left pixel at (0, 0)), with that
/// many digits.
cv::Point fixedPoint(const cv::Point2d& place);

/// Pixels that a line of text covers, its height above the baseline.
cv::Size sizeOfText(const std::string& text, double size);

/// Writes to the right of `baseline`, and returns the x where the text ends. `size`: OpenCV's
/// font scale.
int writeText(const std::string& text, const cv::Point& baseline, const cv::Scalar& color,
              double size, cv::Mat* image);

}  // namespace omnitag
