#include "adjustment/residual_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "adjustment/calibration_report.h"
#include "adjustment/outliers.h"
#include "adjustment/residual_style.h"
#include "common/drawing.h"

namespace omnitag {
namespace {

const cv::Scalar kGrey(150, 150, 150);
const cv::Scalar kRadial(200, 90, 0);
const cv::Scalar kTangential(0, 120, 220);

/// The least multiple of 0.05 pixels that all of these RMS are below.
double roundedUp(double most) { return std::max(0.05, std::ceil(most * 20.0) / 20.0); }

/// The coordinates of a chart, both of which begin at 0.
class Axes {
 public:
  Axes(const cv::Mat& chart, double last, double most)
      : chart_(chart),
        right_(chart.cols - 20),
        bottom_(chart.rows - 60),
        last_(last),
        most_(most) {}

  int x(double value) const {
    return kLeft + static_cast<int>(std::lround(value / last_ * (right_ - kLeft)));
  }
  int y(double rms) const {
    return bottom_ - static_cast<int>(std::lround(rms / most_ * (bottom_ - kTop)));
  }
  int right() const { return right_; }
  int bottom() const { return bottom_; }

  /// `title` is what the values along the axis are.
  void draw(const std::string& title) {
    constexpr int kTicks = 5;
    constexpr double kShort = 20.0;
    for (int i = 0; i <= kTicks; ++i) {
      const double share = static_cast<double>(i) / kTicks;
      const int height = y(share * most_);
      cv::line(chart_, {kLeft, height}, {right_, height}, kGrey, 1);
      residual_style::write(decimals(share * most_, 2), {8, height + 5}, &chart_);
      residual_style::write(decimals(share * last_, last_ < kShort ? 1 : 0),
                            {x(share * last_) - 12, bottom_ + 20}, &chart_);
    }
    residual_style::write(title, {kLeft + 100, bottom_ + 42}, &chart_);
  }

  static constexpr int kLeft = 60;
  static constexpr int kTop = 70;

 private:
  cv::Mat chart_;
  int right_;
  int bottom_;
  double last_;
  double most_;
};

constexpr int kRings = 16;
constexpr int kFewest = 5;

/// The corners in one ring of the image.
struct Ring {
  /// Pixels, RMS along the radius and across it; squares until all corners are summed up.
  double radial = 0.0;
  double tangential = 0.0;
  int count = 0;
};

/// `last`: pixels, the radius of the outermost ring. Rings with too few corners have none.
std::array<Ring, kRings> ringsOf(const std::vector<CornerResidual>& corners,
                                 const Eigen::Vector2d& centre, double last) {
  std::array<Ring, kRings> rings{};
  const double far = farLimit(corners);
  for (const CornerResidual& corner : corners) {
    if (lengthOf(corner) > far) continue;
    const Eigen::Vector2d way = corner.pixel - centre;
    const double along = way.normalized().dot(*corner.residual);
    const auto index = static_cast<std::size_t>(
        std::clamp(static_cast<int>(kRings * way.norm() / last), 0, kRings - 1));
    rings.at(index).radial += along * along;
    rings.at(index).tangential += corner.residual->squaredNorm() - along * along;
    ++rings.at(index).count;
  }
  for (Ring& ring : rings) {
    if (ring.count < kFewest) {
      ring = {};
      continue;
    }
    ring.radial = std::sqrt(ring.radial / ring.count);
    ring.tangential = std::sqrt(ring.tangential / ring.count);
  }
  return rings;
}

/// Writes the stamp of an image at its dot unless that would cover another.
void writeStamp(const std::string& stamp, const cv::Point& dot, const Axes& axes,
                std::vector<cv::Rect>* written, cv::Mat* chart) {
  const cv::Size size = sizeOfText(stamp, residual_style::kTextSize);
  const int left = dot.x + 8 + size.width < axes.right() ? dot.x + 8 : dot.x - 8 - size.width;
  const cv::Rect place(left, dot.y + 4 - size.height, size.width, size.height + 4);
  const bool covers =
      std::any_of(written->begin(), written->end(),
                  [&place](const cv::Rect& other) { return (place & other).area() > 0; });
  if (covers) return;
  residual_style::write(stamp, {left, dot.y + 4}, chart, residual_style::kBad);
  written->push_back(place);
}

}  // namespace

void drawRadiusChart(const std::vector<CornerResidual>& corners, const CameraModel& camera,
                     cv::Mat chart) {
  const double last = camera.rimPixels();
  const auto rings = ringsOf(corners, camera.imagePlane().principalPoint(), last);
  double most = 0.0;
  for (const Ring& ring : rings) most = std::max({most, ring.radial, ring.tangential});
  Axes axes(chart, last, roundedUp(most));
  axes.draw("distance from the centre (px)");
  residual_style::write("RMS of the residuals (px):", {Axes::kLeft, 30}, &chart);
  residual_style::write("along the radius", {Axes::kLeft, 50}, &chart, kRadial);
  residual_style::write("across it", {Axes::kLeft + 160, 50}, &chart, kTangential);
  constexpr int kGap = 2;
  const double step = last / kRings;
  double start = 0.0;
  for (const Ring& ring : rings) {
    const double end = start + step;
    if (ring.count > 0) {
      const int middle = axes.x(0.5 * (start + end));
      cv::rectangle(chart, cv::Point(axes.x(start) + kGap, axes.y(ring.radial)),
                    cv::Point(middle, axes.bottom()), kRadial, cv::FILLED);
      cv::rectangle(chart, cv::Point(middle, axes.y(ring.tangential)),
                    cv::Point(axes.x(end) - kGap, axes.bottom()), kTangential, cv::FILLED);
    }
    start = end;
  }
}

void drawTimeChart(const std::vector<ImageResidual>& images, cv::Mat chart) {
  residual_style::write("RMS of the residuals of each image (px), and their median;",
                        {Axes::kLeft, 30}, &chart);
  residual_style::write("red, with its stamp (s): above twice the median, or most corners left out",
                        {Axes::kLeft, 50}, &chart, residual_style::kBad);
  if (images.empty()) return;
  const auto ends = std::minmax_element(
      images.begin(), images.end(),
      [](const ImageResidual& a, const ImageResidual& b) { return a.stamp < b.stamp; });
  const double start = ends.first->stamp;
  double most = 0.0;
  for (const ImageResidual& image : images) most = std::max(most, image.rms);
  constexpr double kShortest = 1e-3;  // s
  Axes axes(chart, std::max(kShortest, ends.second->stamp - start), roundedUp(most));
  axes.draw("time since the first image (s)");
  const int middle = axes.y(medianRms(images));
  cv::line(chart, {Axes::kLeft, middle}, {axes.right(), middle}, residual_style::kGood, 1);
  // An image without any corner in use is at the top.
  const auto dotOf = [&](const ImageResidual& image) {
    return cv::Point(axes.x(image.stamp - start), image.used > 0 ? axes.y(image.rms) : Axes::kTop);
  };
  constexpr int kRadius = 3;
  for (const ImageResidual& image : images) {
    if (image.used + image.left_out == 0) continue;
    cv::circle(chart, dotOf(image), kRadius, residual_style::kGood, cv::FILLED, cv::LINE_AA);
  }
  constexpr std::size_t kMostStamps = 8;
  const std::vector<std::size_t> outstanding = outstandingImages(images);
  std::vector<cv::Rect> written;
  for (const std::size_t index : outstanding) {
    const ImageResidual& image = images[index];
    cv::circle(chart, dotOf(image), kRadius, residual_style::kBad, cv::FILLED, cv::LINE_AA);
    if (written.size() >= kMostStamps) continue;
    writeStamp(decimals(image.stamp, 2), dotOf(image), axes, &written, &chart);
  }
}

}  // namespace omnitag
