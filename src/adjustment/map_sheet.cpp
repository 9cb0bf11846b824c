#include "adjustment/map_sheet.h"

#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/drawing.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

const cv::Scalar kPaper(255, 255, 255);
const cv::Scalar kGrid(232, 232, 232);
const cv::Scalar kGridText(110, 110, 110);

constexpr int kEllipseSteps = 72;

double turnOf(int step) { return 2.0 * kPi * step / kEllipseSteps; }

}  // namespace

MapSheet::MapSheet(const Eigen::Vector2d& low, const Eigen::Vector2d& high)
    : low_(low), high_(high) {
  constexpr double kLongerSide = 1100.0;  // pixels
  scale_ = kLongerSide / (high - low).maxCoeff();
  const Eigen::Vector2d size = scale_ * (high - low);
  image_ = cv::Mat(static_cast<int>(size.y()) + 1, static_cast<int>(size.x()) + 1, CV_8UC3, kPaper);
  drawGrid();
}

void MapSheet::line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const cv::Scalar& color,
                    int width) {
  cv::line(image_, fixedPoint(position(a)), fixedPoint(position(b)), color, width, cv::LINE_AA,
           kFractionalBits);
}

void MapSheet::text(const Eigen::Vector2d& middle, const std::string& words,
                    const cv::Scalar& color) {
  constexpr double kSize = 0.45;
  const cv::Size size = sizeOfText(words, kSize);
  const cv::Point at = position(middle);
  writeText(words, {at.x - size.width / 2, at.y + size.height / 2}, color, kSize, &image_);
}

void MapSheet::filledEllipse(const Eigen::Vector2d& centre, const ErrorEllipse& ellipse,
                             const cv::Scalar& color) {
  std::vector<cv::Point> outline;
  outline.reserve(kEllipseSteps);
  for (int i = 0; i < kEllipseSteps; ++i) {
    outline.push_back(fixedPoint(position(ellipse.point(centre, turnOf(i)))));
  }
  cv::fillConvexPoly(image_, outline, color, cv::LINE_AA, kFractionalBits);
}

void MapSheet::dashedEllipse(const Eigen::Vector2d& centre, const ErrorEllipse& ellipse,
                             const cv::Scalar& color) {
  for (int i = 0; i < kEllipseSteps; i += 2) {
    line(ellipse.point(centre, turnOf(i)), ellipse.point(centre, turnOf(i + 1)), color, 1);
  }
}

void MapSheet::drawGrid() {
  const Eigen::Vector2i first = low_.array().ceil().matrix().cast<int>();
  const Eigen::Vector2i last = high_.array().floor().matrix().cast<int>();
  for (int x = first.x(); x <= last.x(); ++x) {
    line({x, low_.y()}, {x, high_.y()}, kGrid, 1);
    text({x, low_.y() + 0.15}, std::to_string(x), kGridText);
  }
  for (int y = first.y(); y <= last.y(); ++y) {
    line({low_.x(), y}, {high_.x(), y}, kGrid, 1);
    text({low_.x() + 0.15, y}, std::to_string(y), kGridText);
  }
}

cv::Point2d MapSheet::position(const Eigen::Vector2d& point) const {
  return {scale_ * (point.x() - low_.x()), scale_ * (high_.y() - point.y())};
}

}  // namespace omnitag
