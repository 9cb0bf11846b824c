#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>

namespace omnitag {

/// Fractional bits of the fixed-point coordinates that OpenCV's drawing functions take (their
/// `shift`).
constexpr int kFractionalBits = 4;

/// A position in an image (pixels, the centre of the top-left pixel at (0, 0)) in this fixed-point
/// format.
cv::Point fixedPoint(const cv::Point2d& place);

/// Pixels, size of a line of text; the height is counted from the baseline.
cv::Size sizeOfText(const std::string& text, double size);

/// Writes to the right of `baseline`, and returns the x where the text ends. `size`: OpenCV's
/// font scale.
int writeText(const std::string& text, const cv::Point& baseline, const cv::Scalar& color,
              double size, cv::Mat* image);

}  // namespace omnitag
