#include "adjustment/map_picture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "adjustment/error_ellipse.h"
#include "adjustment/map_sheet.h"
#include "common/drawing.h"
#include "common/format.h"

namespace omnitag {
namespace {

/// B, G, R.
const cv::Scalar kText(110, 110, 110);
const cv::Scalar kWay(120, 180, 120);
const cv::Scalar kSeed(30, 30, 30);
const cv::Scalar kFound(190, 90, 20);
const cv::Scalar kEllipse(230, 190, 150);
const cv::Scalar kBefore(150, 150, 150);

constexpr double kMargin = 0.7;  // m, around markers and poses; ellipses find room in it

/// Whether the seed had another place for a marker that was found, within known deviations.
bool hasBefore(const BuiltMarker& built) {
  return built.isFound() && built.survey && built.survey->deviations.allFinite();
}

Eigen::Vector2d placeOf(const BuiltMarker& built) { return built.marker.center().head<2>(); }

Eigen::Vector2d placeBefore(const BuiltMarker& built) {
  return built.survey->map_from_marker.translation().head<2>();
}

ErrorEllipse ellipseOf(const BuiltMarker& built) {
  return errorEllipse(built.covariance.topLeftCorner<2, 2>());
}

ErrorEllipse ellipseBefore(const BuiltMarker& built) {
  const Eigen::Vector2d variances = built.survey->deviations.head<2>().cwiseAbs2();
  return errorEllipse(variances.asDiagonal());
}

ErrorEllipse magnified(const ErrorEllipse& ellipse, int magnification) {
  return {magnification * ellipse.major, magnification * ellipse.minor, ellipse.direction};
}

int magnificationOf(const std::vector<BuiltMarker>& markers) {
  double largest = 0.0;
  for (const BuiltMarker& each : markers) {
    if (each.isFound()) largest = std::max(largest, ellipseOf(each).major);
    if (hasBefore(each)) largest = std::max(largest, ellipseBefore(each).major);
  }
  return magnificationFor(largest, kMargin);
}

void drawOutline(const Marker& marker, const cv::Scalar& color, MapSheet* sheet) {
  const Corners<Eigen::Vector3d> corners = marker.corners();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    sheet->line(corners[k].head<2>(), corners[(k + 1) % corners.size()].head<2>(), color, 2);
  }
}

/// What the seed said about a marker.
void drawBefore(const BuiltMarker& built, int magnification, MapSheet* sheet) {
  const Eigen::Vector2d now = placeOf(built);
  const Eigen::Vector2d shift = placeBefore(built) - now;
  constexpr double kFar = 3.0 * kMargin;
  if (magnification * shift.norm() <= kFar) {
    const Eigen::Vector2d before = now + magnification * shift;
    sheet->line(before, now, kBefore, 1);
    sheet->dashedEllipse(before, magnified(ellipseBefore(built), magnification), kBefore);
    return;
  }
  Marker marker = built.marker;
  marker.map_from_marker = built.survey->map_from_marker;
  sheet->line(placeBefore(built), now, kBefore, 1);
  drawOutline(marker, kBefore, sheet);
}

void drawMarker(const BuiltMarker& built, MapSheet* sheet) {
  const Marker& marker = built.marker;
  const cv::Scalar& color = built.is_exact ? kSeed : kFound;
  drawOutline(marker, color, sheet);
  const Eigen::Vector2d center = placeOf(built);
  const Eigen::Vector2d normal = marker.normal().head<2>();
  sheet->line(center, center + 0.2 * normal, color, 1);
  sheet->text(center - 0.22 * normal, std::to_string(marker.id), color);
}

MapSheet sheetOver(const BuiltMap& map) {
  Eigen::Vector2d low = map.trajectory.empty()
                            ? Eigen::Vector2d(0.0, 0.0)
                            : Eigen::Vector2d(map.trajectory[0].x, map.trajectory[0].y);
  Eigen::Vector2d high = low;
  const auto include = [&](const Eigen::Vector2d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  };
  for (const BuiltMarker& marker : map.markers) {
    include(placeOf(marker));
    if (hasBefore(marker)) include(placeBefore(marker));
  }
  for (const Pose& pose : map.trajectory) include({pose.x, pose.y});
  const Eigen::Vector2d margin(kMargin, kMargin);
  return {low - margin, high + margin};
}

using LegendLine = std::pair<std::string, cv::Scalar>;

std::vector<LegendLine> legendOf(const BuiltMap& map, int magnification) {
  std::vector<LegendLine> lines = {
      {"metres; green: the robot's way; black: markers that are exactly known", kText},
      {format("blue: markers that were found; shaded: their standard deviations, %d x",
              magnification),
       kFound}};
  if (std::any_of(map.markers.begin(), map.markers.end(), hasBefore)) {
    lines.emplace_back(
        format("dashed: the standard deviations before, about the place before, all %d x;",
               magnification),
        kText);
    lines.emplace_back("grey: the true place before, of a marker that is farther away from it",
                       kText);
  }
  return lines;
}

cv::Mat withLegend(const cv::Mat& picture, const std::vector<LegendLine>& lines) {
  constexpr double kSize = 0.45;
  constexpr int kLine = 20;
  constexpr int kEdge = 10;
  int width = picture.cols;
  for (const LegendLine& line : lines) {
    width = std::max(width, sizeOfText(line.first, kSize).width + 2 * kEdge);
  }
  cv::Mat result;
  cv::copyMakeBorder(picture, result, 0, kLine * static_cast<int>(lines.size()) + kEdge, 0,
                     width - picture.cols, cv::BORDER_CONSTANT, cv::Scalar(255, 255, 255));
  int baseline = picture.rows;
  for (const LegendLine& line : lines) {
    baseline += kLine;
    writeText(line.first, {kEdge, baseline}, line.second, kSize, &result);
  }
  return result;
}

}  // namespace

cv::Mat mapPicture(const BuiltMap& map) {
  const int magnification = magnificationOf(map.markers);
  MapSheet sheet = sheetOver(map);
  for (const BuiltMarker& marker : map.markers) {
    if (!marker.isFound()) continue;
    sheet.filledEllipse(placeOf(marker), magnified(ellipseOf(marker), magnification), kEllipse);
  }
  for (const BuiltMarker& marker : map.markers) {
    if (hasBefore(marker)) drawBefore(marker, magnification, &sheet);
  }
  for (std::size_t i = 1; i < map.trajectory.size(); ++i) {
    const Pose& from = map.trajectory[i - 1];
    const Pose& to = map.trajectory[i];
    sheet.line({from.x, from.y}, {to.x, to.y}, kWay, 2);
  }
  for (const BuiltMarker& marker : map.markers) drawMarker(marker, &sheet);
  return withLegend(sheet.image(), legendOf(map, magnification));
}

}  // namespace omnitag
