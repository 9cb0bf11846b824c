#include "adjustment/residual_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "adjustment/calibration_report.h"
#include "adjustment/outliers.h"
#include "common/drawing.h"

namespace omnitag {
namespace {

const cv::Scalar kBlack(0, 0, 0);
const cv::Scalar kGrey(150, 150, 150);
const cv::Scalar kCircle(200, 140, 0);
const cv::Scalar kGood(40, 160, 40);
const cv::Scalar kBad(30, 30, 220);
const cv::Scalar kRadial(200, 90, 0);
const cv::Scalar kTangential(0, 120, 220);

constexpr int kImageSide = 900;
constexpr int kChartWidth = 520;
constexpr int kMargin = 60;
constexpr double kMagnified = 200.0;  // pixels of the picture per pixel of residual, at 900
constexpr double kTextSize = 0.45;

void write(const std::string& text, const cv::Point& place, cv::Mat* picture,
           const cv::Scalar& colour = kBlack) {
  writeText(text, place, colour, kTextSize, picture);
}

/// Squared residuals of the corners in one ring of the image.
struct Ring {
  double radial = 0.0;
  double tangential = 0.0;
  int count = 0;
};

cv::Mat drawArrows(const CalibrationResult& result, const CameraModel& camera, const cv::Mat& image,
                   double far) {
  const double scale = static_cast<double>(kImageSide) / std::max(image.cols, image.rows);
  cv::Mat picture;
  cv::resize(image, picture, {}, scale, scale, cv::INTER_LINEAR);
  // Pale, so that arrows stand out.
  picture.convertTo(picture, CV_8U, 0.4, 153.0);
  cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
  const auto place = [scale](const Eigen::Vector2d& pixel) {
    return cv::Point2d(scale * (pixel.x() + 0.5) - 0.5, scale * (pixel.y() + 0.5) - 0.5);
  };
  const ImagePlane& plane = camera.imagePlane();
  for (const double radius : {camera.minRadius(), camera.maxRadius()}) {
    cv::circle(
        picture, fixedPoint(place(plane.principalPoint())),
        static_cast<int>(std::lround(scale * plane.scale() * radius * (1 << kFractionalBits))),
        kCircle, 1, cv::LINE_AA, kFractionalBits);
  }
  for (const CornerResidual& corner : result.residuals) {
    const double length = lengthOf(corner);
    const cv::Point2d start = place(corner.pixel);
    if (length > far) {
      cv::circle(picture, fixedPoint(start), 3 << kFractionalBits, kBad, 1, cv::LINE_AA,
                 kFractionalBits);
      continue;
    }
    const cv::Point2d end =
        start + kMagnified * cv::Point2d(corner.residual->x(), corner.residual->y());
    cv::arrowedLine(picture, fixedPoint(start), fixedPoint(end),
                    length > 3.0 * std::sqrt(2.0) * result.noise ? kBad : kGood, 1, cv::LINE_AA,
                    kFractionalBits, 0.2);
  }
  return picture;
}

void drawChart(const CalibrationResult& result, const CameraModel& camera, double far,
               cv::Mat chart) {
  constexpr int kRings = 16;
  std::array<Ring, kRings> rings{};
  const Eigen::Vector2d& centre = camera.imagePlane().principalPoint();
  const double last = camera.rimPixels();
  for (const CornerResidual& corner : result.residuals) {
    if (lengthOf(corner) > far) continue;
    const Eigen::Vector2d way = corner.pixel - centre;
    const Eigen::Vector2d radial = way.normalized();
    const double along = radial.dot(*corner.residual);
    const auto index = static_cast<std::size_t>(
        std::clamp(static_cast<int>(kRings * way.norm() / last), 0, kRings - 1));
    rings.at(index).radial += along * along;
    rings.at(index).tangential += corner.residual->squaredNorm() - along * along;
    ++rings.at(index).count;
  }
  constexpr int kFewest = 5;
  double most = 0.0;
  for (Ring& ring : rings) {
    if (ring.count < kFewest) continue;
    ring.radial = std::sqrt(ring.radial / ring.count);
    ring.tangential = std::sqrt(ring.tangential / ring.count);
    most = std::max({most, ring.radial, ring.tangential});
  }
  most = std::max(0.05, std::ceil(most * 20.0) / 20.0);

  const int left = kMargin;
  const int right = chart.cols - 20;
  const int bottom = chart.rows - kMargin;
  const int top = 2 * kMargin;
  const auto x = [&](double share) {
    return left + static_cast<int>(std::lround(share * (right - left)));
  };
  const auto y = [&](double rms) {
    return bottom - static_cast<int>(std::lround(rms / most * (bottom - top)));
  };
  constexpr int kTicks = 5;
  for (int i = 0; i <= kTicks; ++i) {
    const double share = static_cast<double>(i) / kTicks;
    cv::line(chart, {left, y(share * most)}, {right, y(share * most)}, kGrey, 1);
    write(decimals(share * most, 2), {8, y(share * most) + 5}, &chart);
    write(decimals(share * last, 0), {x(share) - 12, bottom + 20}, &chart);
  }
  write("distance from the centre (px)", {left + 100, bottom + 42}, &chart);
  write("RMS of the residuals (px):", {left, top - 40}, &chart);
  write("along the radius", {left, top - 20}, &chart, kRadial);
  write("across it", {left + 160, top - 20}, &chart, kTangential);
  for (int i = 0; i < kRings; ++i) {
    const Ring& ring = rings.at(static_cast<std::size_t>(i));
    if (ring.count < kFewest) continue;
    const double step = 1.0 / kRings;
    const int gap = 2;
    const int middle = x((i + 0.5) * step);
    cv::rectangle(chart, cv::Point(x(i * step) + gap, y(ring.radial)), cv::Point(middle, bottom),
                  kRadial, cv::FILLED);
    cv::rectangle(chart, cv::Point(middle, y(ring.tangential)),
                  cv::Point(x((i + 1) * step) - gap, bottom), kTangential, cv::FILLED);
  }
}

}  // namespace

cv::Mat residualPicture(const CalibrationResult& result, const CameraModel& camera,
                        const cv::Mat& image) {
  const double far = farLimit(result.residuals);
  const cv::Mat arrows = drawArrows(result, camera, image, far);
  cv::Mat picture(std::max(arrows.rows, 500) + kMargin, arrows.cols + kChartWidth, CV_8UC3,
                  cv::Scalar(255, 255, 255));
  arrows.copyTo(picture(cv::Rect(0, kMargin, arrows.cols, arrows.rows)));
  write("residuals of " + std::to_string(result.after.counted) + " corners, " +
            std::to_string(result.frames) + " images: RMS " + decimals(result.after.rms, 3) +
            " px (before: " + decimals(result.before.rms, 2) + " px)",
        {10, 22}, &picture);
  write(
      "an arrow as long as this is 0.25 px; red: beyond 3 standard deviations; a red circle: left "
      "out",
      {10, 44}, &picture);
  const int length = static_cast<int>(kMagnified / 4.0);
  cv::arrowedLine(picture, {arrows.cols - length - 20, 40}, {arrows.cols - 20, 40}, kGood, 1,
                  cv::LINE_AA, 0, 0.2);
  drawChart(result, camera, far, picture(cv::Rect(arrows.cols, 0, kChartWidth, picture.rows)));
  return picture;
}

}  // namespace omnitag
