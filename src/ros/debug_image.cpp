#include "ros/debug_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "common/drawing.h"
#include "omnitag/common/angle.h"
#include "ros/debug_image_layout.h"

namespace omnitag {
namespace {

using debug_layout::kCell;

const cv::Scalar kBackground(38, 32, 30);
const cv::Scalar kWhite(235, 235, 235);
const cv::Scalar kGray(140, 140, 140);
const cv::Scalar kGreen(95, 220, 75);
const cv::Scalar kOrange(40, 140, 255);
const cv::Scalar kYellow(70, 210, 245);

constexpr int kMargin = 8;
constexpr int kTextLine = 20;

void drawPolygon(const std::vector<cv::Point2d>& corners, const cv::Scalar& color, int thickness,
                 cv::Mat* canvas) {
  if (corners.size() < 2) return;
  std::vector<cv::Point> points;
  points.reserve(corners.size());
  for (const cv::Point2d& corner : corners) points.push_back(fixedPoint(corner));
  cv::polylines(*canvas, points, true, color, thickness, cv::LINE_AA, kFractionalBits);
}

void drawLine(const cv::Point2d& a, const cv::Point2d& b, const cv::Scalar& color,
              cv::Mat* canvas) {
  cv::line(*canvas, fixedPoint(a), fixedPoint(b), color, 1, cv::LINE_AA, kFractionalBits);
}

std::string shortened(std::string text, std::size_t length) {
  if (text.size() > length) text = text.substr(0, length - 2) + "..";
  return text;
}

/// The probabilities of several poses, e.g. "60 : 40 %"; empty for a single one.
std::string oddsOf(const std::vector<WeightedPose>& hypotheses) {
  if (hypotheses.size() < 2) return "";
  std::string text;
  for (const WeightedPose& hypothesis : hypotheses) {
    text += text.empty() ? "" : " : ";
    text += std::to_string(std::lround(1e2 * hypothesis.probability));
  }
  return text + " %";
}

cv::Scalar colorOf(const MarkerDetection* detection) {
  if (detection == nullptr) return kGray;
  return detection->accepted ? kGreen : kOrange;
}

}  // namespace

std::string debugImageTopic(const std::string& camera_name) {
  return (camera_name.empty() ? "" : camera_name + "/") + "debug_image";
}

DebugImagePainter::DebugImagePainter(std::shared_ptr<const CameraModel> camera, MarkerMap map)
    : camera_(std::move(camera)), map_(std::move(map)), warper_(camera_, kWorkingDistance) {
  // The part of the image that shows the world, or the whole image if that is less.
  const ImageSize& size = camera_->imageSize();
  const ImagePlane& plane = camera_->imagePlane();
  constexpr double kRoom = 1.03;
  const double radius = std::min(kRoom * camera_->maxRadius() * plane.scale(),
                                 0.5 * std::hypot(size.width, size.height));
  const cv::Rect middle = debug_layout::middle();
  scale_ = middle.width / (2.0 * radius);
  origin_.x = middle.x + scale_ * (radius - plane.principalPoint().x());
  origin_.y = middle.y + scale_ * (radius - plane.principalPoint().y());
}

cv::Mat DebugImagePainter::paint(const cv::Mat& panorama, const FrameResult& result) const {
  cv::Mat canvas(debug_layout::kSide + debug_layout::kTitleHeight, debug_layout::kSide, CV_8UC3,
                 kBackground);
  paintPanorama(panorama, result, &canvas);

  const std::size_t count =
      std::min(result.views.size(), static_cast<std::size_t>(debug_layout::kSlots));
  const Eigen::Vector2d center = camera_->imagePlane().principalPoint();
  std::vector<cv::Point2d> anchors(count, onCanvas(center));
  std::vector<double> directions(count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const View& view = result.views[i];
    const Eigen::Vector2d middle((view.size.width - 1) / 2.0, (view.size.height - 1) / 2.0);
    const std::optional<Eigen::Vector2d> pixel = warper_.panoramaFromView(view, middle);
    if (!pixel) continue;
    anchors[i] = onCanvas(*pixel);
    directions[i] = std::atan2(pixel->y() - center.y(), pixel->x() - center.x());
  }
  const std::vector<cv::Rect> cells = debug_layout::cellsFor(directions);
  for (std::size_t i = 0; i < count; ++i) {
    const cv::Point2d cell_center = 0.5 * cv::Point2d(cells[i].tl() + cells[i].br());
    drawLine(anchors[i], cell_center, kGray, &canvas);
  }
  for (std::size_t i = 0; i < count; ++i) paintView(result, i, cells[i], &canvas);
  paintTitle(result, &canvas);
  return canvas;
}

void DebugImagePainter::paintPanorama(const cv::Mat& panorama, const FrameResult& result,
                                      cv::Mat* canvas) const {
  const cv::Rect middle = debug_layout::middle();
  const cv::Matx23d canvas_from_panorama(scale_, 0.0, origin_.x - middle.x,  //
                                         0.0, scale_, origin_.y - middle.y);
  cv::Mat enlarged;
  cv::warpAffine(panorama, enlarged, canvas_from_panorama, middle.size(), cv::INTER_LINEAR);
  cv::cvtColor(enlarged, (*canvas)(middle), cv::COLOR_GRAY2BGR);

  const cv::Point2d center = onCanvas(camera_->imagePlane().principalPoint());
  for (const PredictedMarker& marker : result.predicted) {
    const cv::Point2d line = onCanvas(marker.center) - center;
    double length = cv::norm(line);
    for (const Eigen::Vector2d& corner : marker.corners) {
      length = std::min(length, cv::norm(onCanvas(corner) - center));
    }
    drawLine(center, center + (length / cv::norm(line)) * line, kYellow, canvas);
  }
  for (const View& view : result.views) drawPolygon(outline(view), kGray, 1, canvas);
  for (const MarkerDetection& detection : result.detections) {
    std::vector<cv::Point2d> corners;
    for (const Eigen::Vector2d& corner : detection.corners) corners.push_back(onCanvas(corner));
    drawPolygon(corners, colorOf(&detection), 2, canvas);
  }
}

void DebugImagePainter::paintView(const FrameResult& result, std::size_t view_index,
                                  const cv::Rect& cell, cv::Mat* canvas) const {
  const View& view = result.views[view_index];
  const std::vector<Sighting> sightings = sightingsIn(view, result);
  const std::vector<const MarkerDetection*> rejected = rejectedIn(view, result);
  const auto used = static_cast<std::size_t>(
      std::count_if(sightings.begin(), sightings.end(), [](const Sighting& sighting) {
        return sighting.detected != nullptr && sighting.detected->accepted;
      }));

  cv::Mat image;
  cv::cvtColor(result.view_images[view_index], image, cv::COLOR_GRAY2BGR);
  const cv::Size room(kCell - 2 * kMargin, kCell - 2 * kMargin - 2 * kTextLine);
  const double zoom = std::min(static_cast<double>(room.width) / image.cols,
                               static_cast<double>(room.height) / image.rows);
  const cv::Size size(std::max(1, cvFloor(zoom * image.cols)),
                      std::max(1, cvFloor(zoom * image.rows)));
  cv::resize(image, image, size, 0.0, 0.0, zoom < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
  const auto drawCorners = [&](const Corners<Eigen::Vector2d>& corners, const cv::Scalar& color) {
    std::vector<cv::Point2d> polygon = inView(view, corners);
    for (cv::Point2d& corner : polygon) {
      corner = zoom * (corner + cv::Point2d(0.5, 0.5)) - cv::Point2d(0.5, 0.5);
    }
    drawPolygon(polygon, color, 1, &image);
  };
  for (const Sighting& sighting : sightings) {
    if (sighting.detected == nullptr) drawCorners(sighting.predicted->corners, kYellow);
    if (sighting.detected != nullptr) drawCorners(sighting.detected->corners, kGreen);
  }
  for (const MarkerDetection* detection : rejected) drawCorners(detection->corners, kOrange);

  // The words are on the side away from the line to the panorama.
  const bool is_below = cell.y > debug_layout::middle().y + debug_layout::middle().height / 2;
  const int words_height = 2 * kTextLine;
  const cv::Point corner(
      cell.x + (kCell - size.width) / 2,
      cell.y + kMargin + (is_below ? 0 : words_height) + (room.height - size.height) / 2);
  image.copyTo((*canvas)(cv::Rect(corner, size)));
  const cv::Scalar frame_color = used > 0 ? kGreen : (rejected.empty() ? kGray : kOrange);
  cv::rectangle(*canvas, cv::Rect(corner, size), frame_color, 1);

  constexpr double kTextSize = 0.5;
  // The words of a narrow view must stay on the canvas.
  const auto startOf = [&](int width) { return std::min(corner.x, cell.x + kCell - width); };
  int ids_width = 0;
  for (const Sighting& sighting : sightings) {
    ids_width +=
        kMargin + sizeOfText(std::to_string(map_.markers[sighting.map_entry].id), kTextSize).width;
  }
  cv::Point pen(startOf(ids_width), is_below ? corner.y + size.height + kTextLine
                                             : corner.y - words_height + kTextLine - kMargin / 2);
  for (const Sighting& sighting : sightings) {
    const Marker& marker = map_.markers[sighting.map_entry];
    pen.x =
        writeText(std::to_string(marker.id), pen, colorOf(sighting.detected), kTextSize, canvas) +
        kMargin;
  }
  std::string verdict = sightings.empty() ? "no marker" : "not detected";
  if (used > 0) verdict = "DETECTED";
  if (used > 0 && used < sightings.size()) {
    verdict = std::to_string(used) + " of " + std::to_string(sightings.size()) + " DETECTED";
  }
  if (used == 0 && !rejected.empty()) {
    verdict = std::to_string(rejected.front()->id) + ": " + shortened(rejected.front()->reason, 18);
  }
  writeText(verdict, {startOf(sizeOfText(verdict, kTextSize).width), pen.y + kTextLine},
            frame_color, kTextSize, canvas);
}

void DebugImagePainter::paintTitle(const FrameResult& result, cv::Mat* canvas) {
  constexpr double kTextSize = 0.5;
  const bool has_pose = result.map_from_base.has_value();
  const bool is_measured = result.mode == Mode::kTracking || result.mode == Mode::kFound;
  const cv::Scalar color = is_measured ? kGreen : (has_pose ? kYellow : kOrange);
  cv::Point pen(kMargin, 29);
  pen.x = writeText(toString(result.mode), pen, color, kTextSize, canvas) + 2 * kMargin;
  std::array<char, 200> words{};
  // A search expects no markers.
  const std::string of =
      result.predicted.empty() ? "" : " of " + std::to_string(result.predicted.size());
  std::snprintf(words.data(), words.size(), "%d%s markers   %.0f ms", result.acceptedMarkers(),
                of.c_str(), 1e3 * result.timings.total);
  pen.x = writeText(words.data(), pen, kWhite, kTextSize, canvas) + 2 * kMargin;
  if (const std::string odds = oddsOf(result.hypotheses); !odds.empty()) {
    pen.x = writeText(odds, pen, kYellow, kTextSize, canvas) + 2 * kMargin;
  }
  if (!has_pose) {
    writeText(result.remark, pen, color, kTextSize, canvas);
    return;
  }
  const Pose pose = result.publishedPose().pose;
  std::snprintf(words.data(), words.size(),
                "x %.3f m  y %.3f m  yaw %.2f deg  sigma %.2g mm, %.2g deg", pose.x, pose.y,
                degrees(pose.yaw), 1e3 * positionDeviation(*result.map_from_base),
                degrees(std::sqrt(result.map_from_base->covariance(2, 2))));
  writeText(words.data(), pen, kWhite, kTextSize, canvas);
}

std::vector<DebugImagePainter::Sighting> DebugImagePainter::sightingsIn(
    const View& view, const FrameResult& result) const {
  std::vector<Sighting> sightings;
  for (const PredictedMarker& predicted : result.predicted) {
    if (isIn(view, predicted.center)) {
      sightings.push_back({predicted.map_entry, &predicted, nullptr});
    }
  }
  for (const MarkerDetection& detection : result.detections) {
    if (!detection.accepted) continue;
    const auto sighting =
        std::find_if(sightings.begin(), sightings.end(),
                     [&](const Sighting& each) { return each.map_entry == *detection.map_entry; });
    if (sighting != sightings.end()) {
      sighting->detected = &detection;
    } else if (isIn(view, detection.center)) {
      sightings.push_back({*detection.map_entry, nullptr, &detection});
    }
  }
  return sightings;
}

std::vector<const MarkerDetection*> DebugImagePainter::rejectedIn(const View& view,
                                                                  const FrameResult& result) const {
  std::vector<const MarkerDetection*> rejected;
  for (const MarkerDetection& detection : result.detections) {
    if (!detection.accepted && isIn(view, detection.center)) rejected.push_back(&detection);
  }
  return rejected;
}

bool DebugImagePainter::isIn(const View& view, const Eigen::Vector2d& panorama_pixel) const {
  const std::optional<Eigen::Vector2d> position = warper_.viewFromPanorama(view, panorama_pixel);
  return position && position->x() > -0.5 && position->y() > -0.5 &&
         position->x() < view.size.width - 0.5 && position->y() < view.size.height - 0.5;
}

std::vector<cv::Point2d> DebugImagePainter::outline(const View& view) const {
  constexpr int kSteps = 12;
  const double right = view.size.width - 1;
  const double bottom = view.size.height - 1;
  const std::array<Eigen::Vector2d, 5> corners = {
      Eigen::Vector2d(0.0, 0.0), {right, 0.0}, {right, bottom}, {0.0, bottom}, {0.0, 0.0}};
  std::vector<cv::Point2d> points;
  for (std::size_t side = 0; side + 1 < corners.size(); ++side) {
    for (int step = 0; step < kSteps; ++step) {
      const double share = static_cast<double>(step) / kSteps;
      const Eigen::Vector2d position = (1.0 - share) * corners[side] + share * corners[side + 1];
      const std::optional<Eigen::Vector2d> pixel = warper_.panoramaFromView(view, position);
      if (pixel) points.push_back(onCanvas(*pixel));
    }
  }
  return points;
}

std::vector<cv::Point2d> DebugImagePainter::inView(const View& view,
                                                   const Corners<Eigen::Vector2d>& corners) const {
  std::vector<cv::Point2d> points;
  for (const Eigen::Vector2d& corner : corners) {
    const std::optional<Eigen::Vector2d> position = warper_.viewFromPanorama(view, corner);
    if (position) points.emplace_back(position->x(), position->y());
  }
  return points;
}

cv::Point2d DebugImagePainter::onCanvas(const Eigen::Vector2d& panorama_pixel) const {
  return origin_ + scale_ * cv::Point2d(panorama_pixel.x(), panorama_pixel.y());
}

}  // namespace omnitag
