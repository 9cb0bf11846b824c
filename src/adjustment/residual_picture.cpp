#include "adjustment/residual_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "adjustment/calibration_report.h"
#include "adjustment/field_coverage.h"
#include "adjustment/image_residuals.h"
#include "adjustment/outliers.h"
#include "adjustment/residual_charts.h"
#include "adjustment/residual_style.h"
#include "common/drawing.h"

namespace omnitag {
namespace {

const cv::Scalar kCircle(200, 140, 0);
const cv::Vec3b kTint(120, 190, 255);
const cv::Scalar kTintText(0, 110, 200);

constexpr int kImageSide = 900;
constexpr int kChartWidth = 520;
constexpr int kLeastChartHeight = 500;
constexpr int kTimeHeight = 280;
constexpr int kHeader = 82;
constexpr double kMagnified = 200.0;  // pixels of the picture per pixel of residual, at 900

/// The image, enlarged or reduced, and pale, so that arrows stand out.
cv::Mat backgroundOf(const cv::Mat& image, double scale) {
  cv::Mat background;
  cv::resize(image, background, {}, scale, scale, cv::INTER_LINEAR);
  background.convertTo(background, CV_8U, 0.4, 153.0);
  cv::cvtColor(background, background, cv::COLOR_GRAY2BGR);
  return background;
}

/// Tints the cells of the field that have no corner, in squares of a few pixels.
void tintEmptyCells(const std::vector<CornerResidual>& corners, const CameraModel& camera,
                    double scale, cv::Mat* picture) {
  std::vector<Eigen::Vector2d> pixels;
  pixels.reserve(corners.size());
  for (const CornerResidual& corner : corners) pixels.push_back(corner.pixel);
  const std::vector<FieldCell> empty = fieldCoverage(camera, pixels).empty;
  constexpr int kSquare = 3;
  const cv::Rect all(cv::Point(), picture->size());
  for (int y = 0; y < picture->rows; y += kSquare) {
    for (int x = 0; x < picture->cols; x += kSquare) {
      const cv::Rect square = cv::Rect(x, y, kSquare, kSquare) & all;
      const Eigen::Vector2d middle(x + 0.5 * square.width, y + 0.5 * square.height);
      const auto cell = fieldCellOf(camera, middle / scale - Eigen::Vector2d::Constant(0.5));
      if (!cell || std::find(empty.begin(), empty.end(), *cell) == empty.end()) continue;
      cv::Mat part = (*picture)(square);
      cv::addWeighted(part, 0.6, cv::Mat(part.size(), CV_8UC3, cv::Scalar(kTint)), 0.4, 0.0, part);
    }
  }
}

void drawField(const CameraModel& camera, double scale, cv::Mat* picture) {
  const ImagePlane& plane = camera.imagePlane();
  const Eigen::Vector2d centre = scale * (plane.principalPoint() + Eigen::Vector2d::Constant(0.5));
  for (const double radius : {camera.minRadius(), camera.maxRadius()}) {
    cv::circle(
        *picture, fixedPoint({centre.x() - 0.5, centre.y() - 0.5}),
        static_cast<int>(std::lround(scale * plane.scale() * radius * (1 << kFractionalBits))),
        kCircle, 1, cv::LINE_AA, kFractionalBits);
  }
}

/// `rms`: pixels, of all corners.
void drawArrows(const std::vector<CornerResidual>& corners, double rms, double scale,
                cv::Mat* picture) {
  constexpr double kLong = 3.0;
  const double far = farLimit(corners);
  for (const CornerResidual& corner : corners) {
    const double length = lengthOf(corner);
    const Eigen::Vector2d place = scale * (corner.pixel + Eigen::Vector2d::Constant(0.5));
    const cv::Point2d start(place.x() - 0.5, place.y() - 0.5);
    if (length > far) {
      cv::circle(*picture, fixedPoint(start), 3 << kFractionalBits, residual_style::kBad, 1,
                 cv::LINE_AA, kFractionalBits);
      continue;
    }
    const cv::Point2d end =
        start + kMagnified * cv::Point2d(corner.residual->x(), corner.residual->y());
    cv::arrowedLine(*picture, fixedPoint(start), fixedPoint(end),
                    length > kLong * rms ? residual_style::kBad : residual_style::kGood, 1,
                    cv::LINE_AA, kFractionalBits, 0.2);
  }
}

void writeHeader(const PicturedResiduals& residuals, const ResidualSummary& summary, int right,
                 cv::Mat* picture) {
  residual_style::write(
      "residuals of " + std::to_string(summary.counted) + " corners, " +
          std::to_string(residuals.stamps.size()) + " images: RMS " + decimals(summary.rms, 3) +
          " px" +
          (residuals.rms_before ? " (before: " + decimals(*residuals.rms_before, 2) + " px)"
                                : std::string()),
      {10, 22}, picture);
  residual_style::write(
      "an arrow as long as this is 0.25 px; red: beyond three times the RMS; a red circle: left "
      "out",
      {10, 44}, picture);
  residual_style::write("orange: parts of the camera's field without any corner", {10, 66}, picture,
                        kTintText);
  const int length = static_cast<int>(kMagnified / 4.0);
  cv::arrowedLine(*picture, {right - length - 20, 40}, {right - 20, 40}, residual_style::kGood, 1,
                  cv::LINE_AA, 0, 0.2);
}

}  // namespace

cv::Mat residualPicture(const PicturedResiduals& residuals, const CameraModel& camera,
                        const cv::Mat& image) {
  const std::vector<CornerResidual>& corners = residuals.corners;
  const ResidualSummary summary = summarize(corners);
  const double scale = static_cast<double>(kImageSide) / std::max(image.cols, image.rows);
  cv::Mat field = backgroundOf(image, scale);
  tintEmptyCells(corners, camera, scale, &field);
  drawField(camera, scale, &field);
  drawArrows(corners, summary.rms, scale, &field);

  const int width = field.cols + kChartWidth;
  const int height = kHeader + std::max(field.rows, kLeastChartHeight);
  cv::Mat picture(height + kTimeHeight, width, CV_8UC3, cv::Scalar(255, 255, 255));
  field.copyTo(picture(cv::Rect(0, kHeader, field.cols, field.rows)));
  writeHeader(residuals, summary, field.cols, &picture);
  drawRadiusChart(corners, camera, picture(cv::Rect(field.cols, 0, kChartWidth, height)));
  drawTimeChart(imageResiduals(corners, residuals.stamps),
                picture(cv::Rect(0, height, width, kTimeHeight)));
  return picture;
}

}  // namespace omnitag
