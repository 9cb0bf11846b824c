#include "common/drawing.h"

#include <opencv2/imgproc.hpp>

namespace omnitag {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

}  // namespace

cv::Point fixedPoint(const cv::Point2d& place) {
  constexpr double kOne = 1 << kFractionalBits;
  return {cvRound(place.x * kOne), cvRound(place.y * kOne)};
}

cv::Size sizeOfText(const std::string& text, double size) {
  return cv::getTextSize(text, kFont, size, 1, nullptr);
}

int writeText(const std::string& text, const cv::Point& baseline, const cv::Scalar& color,
              double size, cv::Mat* image) {
  cv::putText(*image, text, baseline, kFont, size, color, 1, cv::LINE_AA);
  return baseline.x + sizeOfText(text, size).width;
}

}  // namespace omnitag
