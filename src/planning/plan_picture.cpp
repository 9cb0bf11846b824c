#include "planning/plan_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>

#include "common/bounds.h"
#include "common/drawing.h"
#include "common/format.h"
#include "common/grid_index.h"
#include "planning/colour_scale.h"
#include "planning/plan_report.h"

namespace omnitag {
namespace {

/// B, G, R.
const cv::Scalar kPaper(255, 255, 255);
const cv::Scalar kText(60, 60, 60);
const cv::Scalar kMarker(20, 20, 20);
const cv::Scalar kNewMarker(190, 20, 190);
const cv::Vec3b kWall(90, 90, 90);
const cv::Vec3b kFree(242, 242, 242);
const cv::Vec3b kUnknown(255, 255, 255);
const cv::Vec3b kNothing(205, 205, 205);
const cv::Vec3b kHatch(70, 70, 70);

constexpr int kMargin = 46;  // pixels around the plan, for the axes
constexpr int kLegend = 270;
constexpr double kTextSize = 0.42;

/// Whether a pixel lies on the hatching that shows how few markers are recognized.
bool isHatched(int u, int v, int markers) {
  constexpr int kPeriod = 12;
  const bool is_up = (u + v) % kPeriod == 0;
  const bool is_down = ((u - v) % kPeriod + kPeriod) % kPeriod == 0;
  return (markers <= 2 && is_up) || (markers <= 1 && is_down);
}

cv::Vec3b colourAt(int u, int v, const PlacePrediction& place, const ColourScale& scale) {
  if (isHatched(u, v, place.markers)) return kHatch;
  return place.position_deviation ? scale.colourOf(*place.position_deviation) : kNothing;
}

/// The part of the map that is drawn, and where it is in the picture.
class Frame {
 public:
  Frame(const OccupancyGrid& grid, const MarkerMap& map) {
    constexpr double kLongerSide = 900.0;  // pixels
    for (int row = 0; row < grid.rows(); ++row) {
      for (int column = 0; column < grid.columns(); ++column) {
        if (grid.at(column, row) != Cell::kUnknown) include(grid.middleOf(column, row));
      }
    }
    for (const Marker& marker : map.markers) include(marker.center().head<2>());
    constexpr double kAround = 0.3;  // m
    x_ = {x_.low - kAround, x_.high + kAround};
    y_ = {y_.low - kAround, y_.high + kAround};
    scale_ = kLongerSide / std::max(x_.high - x_.low, y_.high - y_.low);
  }

  int width() const { return cvRound(scale_ * (x_.high - x_.low)); }
  int height() const { return cvRound(scale_ * (y_.high - y_.low)); }
  double pixelsPerMetre() const { return scale_; }
  const Bounds& x() const { return x_; }
  const Bounds& y() const { return y_; }

  cv::Point2d pixelOf(const Eigen::Vector2d& point) const {
    return {kMargin + scale_ * (point.x() - x_.low), kMargin + scale_ * (y_.high - point.y())};
  }
  Eigen::Vector2d pointOf(int u, int v) const {
    return {x_.low + (u - kMargin) / scale_, y_.high - (v - kMargin) / scale_};
  }

 private:
  void include(const Eigen::Vector2d& point) {
    x_.include(point.x());
    y_.include(point.y());
  }

  Bounds x_;
  Bounds y_;
  double scale_ = 1.0;
};

/// Finds the prediction for a cell.
class Lattice {
 public:
  Lattice(const OccupancyGrid& grid, const FloorPrediction& floor)
      : grid_(grid),
        stride_(std::max(1, static_cast<int>(std::lround(floor.step / grid.resolution())))),
        columns_(grid.columns() / stride_ + 1),
        places_(gridIndex(0, grid.rows() / stride_ + 1, columns_)) {
    for (const PlacePrediction& place : floor.places) {
      const Eigen::Vector2i cell = cellOf(place.place);
      places_[indexOf(cell)] = place;
    }
  }

  /// The nearest place to a point of the map, if a robot can stand there.
  const std::optional<PlacePrediction>& at(const Eigen::Vector2d& point) const {
    return places_[indexOf(cellOf(point))];
  }

 private:
  Eigen::Vector2i cellOf(const Eigen::Vector2d& point) const {
    return grid_.cellsFromMap(point).array().floor().matrix().cast<int>();
  }
  std::size_t indexOf(const Eigen::Vector2i& cell) const {
    return gridIndex(cell.x() / stride_, cell.y() / stride_, columns_);
  }

  const OccupancyGrid& grid_;
  int stride_;
  int columns_;
  std::vector<std::optional<PlacePrediction>> places_;
};

void drawFloor(const OccupancyGrid& grid, const FloorPrediction& floor, const ColourScale& scale,
               const Frame& frame, cv::Mat* image) {
  const Lattice lattice(grid, floor);
  for (int v = kMargin; v < kMargin + frame.height(); ++v) {
    for (int u = kMargin; u < kMargin + frame.width(); ++u) {
      const Eigen::Vector2d point = frame.pointOf(u, v);
      const Cell cell = grid.at(point);
      cv::Vec3b colour = cell == Cell::kOccupied ? kWall : kUnknown;
      if (cell == Cell::kFree) {
        const auto& place = lattice.at(point);
        colour = place ? colourAt(u, v, *place, scale) : kFree;
      }
      image->at<cv::Vec3b>(v, u) = colour;
    }
  }
}

/// On a pale ground, so that it is readable on any colour.
void label(const std::string& text, const cv::Point2d& middle, const cv::Scalar& colour,
           cv::Mat* image) {
  const cv::Size size = sizeOfText(text, kTextSize);
  const cv::Point baseline(cvRound(middle.x) - size.width / 2, cvRound(middle.y) + size.height / 2);
  const cv::Rect around(baseline.x - 2, baseline.y - size.height - 2, size.width + 4,
                        size.height + 5);
  cv::Mat ground = (*image)(around & cv::Rect({0, 0}, image->size()));
  constexpr double kPale = 0.75;
  ground.convertTo(ground, -1, 1.0 - kPale, kPale * 255.0);
  writeText(text, baseline, colour, kTextSize, image);
}

void drawMarker(const Marker& marker, const cv::Scalar& colour, const Frame& frame,
                cv::Mat* image) {
  constexpr double kShortest = 10.0;  // pixels
  constexpr double kNormal = 7.0;
  constexpr double kToLabel = 17.0;
  const cv::Point2d center = frame.pixelOf(marker.center().head<2>());
  const Eigen::Vector2d normal = marker.normal().head<2>();
  const cv::Point2d out(normal.x(), -normal.y());
  const cv::Point2d along(out.y, -out.x);
  const double half = 0.5 * std::max(kShortest, frame.pixelsPerMetre() * marker.size);
  const auto line = [&](const cv::Point2d& from, const cv::Point2d& to, int width) {
    cv::line(*image, fixedPoint(from), fixedPoint(to), colour, width, cv::LINE_AA, kFractionalBits);
  };
  line(center - half * along, center + half * along, 3);
  line(center, center + kNormal * out, 1);
  label(std::to_string(marker.id), center + kToLabel * out, colour, image);
}

/// The smallest of 1, 2 or 5 times a power of ten that is at least `least`.
double roundStep(double least) {
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= least) return factor * decade;
  }
  return 10.0 * decade;
}

/// Multiples of the step within the bounds.
std::vector<double> multiplesIn(const Bounds& bounds, double step) {
  const int first = static_cast<int>(std::ceil(bounds.low / step));
  const int last = static_cast<int>(std::floor(bounds.high / step));
  std::vector<double> multiples;
  for (int i = first; i <= last; ++i) multiples.push_back(i * step);
  return multiples;
}

void drawAxes(const Frame& frame, cv::Mat* image) {
  constexpr double kApart = 60.0;  // pixels
  constexpr int kTick = 5;
  const double step = roundStep(kApart / frame.pixelsPerMetre());
  const auto number = [step](double value) { return format(step < 1.0 ? "%.1f" : "%.0f", value); };
  const int bottom = kMargin + frame.height();
  cv::rectangle(*image, {kMargin, kMargin}, {kMargin + frame.width(), bottom}, kText, 1);
  for (const double x : multiplesIn(frame.x(), step)) {
    const int u = cvRound(frame.pixelOf({x, 0.0}).x);
    cv::line(*image, {u, bottom}, {u, bottom + kTick}, kText);
    const cv::Size size = sizeOfText(number(x), kTextSize);
    writeText(number(x), {u - size.width / 2, bottom + kTick + 5 + size.height}, kText, kTextSize,
              image);
  }
  for (const double y : multiplesIn(frame.y(), step)) {
    const int v = cvRound(frame.pixelOf({0.0, y}).y);
    cv::line(*image, {kMargin - kTick, v}, {kMargin, v}, kText);
    const cv::Size size = sizeOfText(number(y), kTextSize);
    writeText(number(y), {kMargin - kTick - 4 - size.width, v + size.height / 2}, kText, kTextSize,
              image);
  }
  writeText("x, y of the map in metres; where the robot's base stands", {kMargin, kMargin - 12},
            kText, kTextSize, image);
}

void drawScale(const ColourScale& scale, const cv::Point& corner, cv::Mat* image) {
  constexpr int kWidth = 24;
  constexpr int kHeight = 220;
  writeText("standard deviation of the", corner + cv::Point(0, -26), kText, kTextSize, image);
  writeText("position from one image", corner + cv::Point(0, -10), kText, kTextSize, image);
  for (int v = 0; v < kHeight; ++v) {
    const cv::Vec3b colour = ColourScale::colourAt(1.0 - (v + 0.5) / kHeight);
    cv::line(*image, corner + cv::Point(0, v), corner + cv::Point(kWidth, v),
             cv::Scalar(colour[0], colour[1], colour[2]));
  }
  cv::rectangle(*image, corner, corner + cv::Point(kWidth, kHeight), kText, 1);
  for (const double tick : scale.ticks()) {
    const int v = cvRound((1.0 - scale.shareOf(tick)) * kHeight);
    cv::line(*image, corner + cv::Point(kWidth, v), corner + cv::Point(kWidth + 5, v), kText);
    const std::string more = tick == scale.ticks().back() ? " or more" : "";
    writeText(lengthText(tick) + more, corner + cv::Point(kWidth + 10, v + 4), kText, kTextSize,
              image);
  }
}

void drawKeys(const ColourScale& scale, bool has_added, cv::Point corner, cv::Mat* image) {
  constexpr int kBox = 24;
  constexpr int kLine = 34;
  const std::array<const char*, 4> words{"no marker is recognized: no pose", "one marker",
                                         "two markers", "three or more"};
  const double middle = scale.ticks()[scale.ticks().size() / 2];
  for (int count = 3; count >= 0; --count) {
    PlacePrediction place;
    place.markers = count;
    if (count > 0) place.position_deviation = middle;
    for (int v = 0; v < kBox; ++v) {
      for (int u = 0; u < kBox; ++u) {
        image->at<cv::Vec3b>(corner.y + v, corner.x + u) =
            colourAt(corner.x + u, corner.y + v, place, scale);
      }
    }
    cv::rectangle(*image, corner, corner + cv::Point(kBox, kBox), kText, 1);
    writeText(words.at(static_cast<std::size_t>(count)), corner + cv::Point(kBox + 10, 17), kText,
              kTextSize, image);
    corner.y += kLine;
  }
  const auto symbol = [&](const cv::Scalar& colour, const std::string& text) {
    cv::line(*image, corner + cv::Point(2, 16), corner + cv::Point(22, 16), colour, 3, cv::LINE_AA);
    cv::line(*image, corner + cv::Point(12, 16), corner + cv::Point(12, 8), colour, 1, cv::LINE_AA);
    writeText(text, corner + cv::Point(kBox + 10, 17), colour, kTextSize, image);
    corner.y += kLine;
  };
  symbol(kMarker, "marker of the map");
  if (has_added) symbol(kNewMarker, "new marker");
}

}  // namespace

cv::Mat planPicture(const OccupancyGrid& grid, const FloorPrediction& floor, const MarkerMap& map,
                    std::size_t added) {
  constexpr int kLegendHeight = 620;
  const Frame frame(grid, map);
  const ColourScale scale(floor);
  const int width = 2 * kMargin + frame.width() + kLegend;
  const int height = std::max(2 * kMargin + frame.height(), kLegendHeight);
  cv::Mat image(height, width, CV_8UC3, kPaper);
  drawFloor(grid, floor, scale, frame, &image);
  drawAxes(frame, &image);
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    const bool is_new = i + added >= map.markers.size();
    drawMarker(map.markers[i], is_new ? kNewMarker : kMarker, frame, &image);
  }
  const int left = kMargin + frame.width() + 30;
  drawScale(scale, {left, kMargin + 40}, &image);
  drawKeys(scale, added > 0, {left, kMargin + 300}, &image);
  return image;
}

}  // namespace omnitag
