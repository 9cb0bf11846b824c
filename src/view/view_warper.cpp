#include "view/view_warper.h"

#include <cmath>
#include <utility>
#include <vector>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// Bilinear; black outside. cv::remap would round positions to 1/32 pixel, which is visible in the
/// corners' positions.
std::uint8_t sample(const cv::Mat& image, float u, float v) {
  if (!(u >= 0.0F && v >= 0.0F && u < static_cast<float>(image.cols - 1) &&
        v < static_cast<float>(image.rows - 1))) {
    return 0;
  }
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const float right = u - static_cast<float>(column);
  const float below = v - static_cast<float>(row);
  const std::uint8_t* top = image.ptr<std::uint8_t>(row) + column;
  const std::uint8_t* bottom = top + image.step[0];
  const auto blend = [right](const std::uint8_t* pixels) {
    const auto left = static_cast<float>(pixels[0]);
    return left + right * (static_cast<float>(pixels[1]) - left);
  };
  return cv::saturate_cast<std::uint8_t>(blend(top) + below * (blend(bottom) - blend(top)));
}

}  // namespace

ViewWarper::ViewWarper(std::shared_ptr<const CameraModel> camera, double working_distance)
    : camera_(std::move(camera)), table_(*camera_, working_distance) {}

cv::Mat ViewWarper::warp(const cv::Mat& panorama, const View& view) const {
  return view.elevation == 0.0 ? warpByTable(panorama, view) : warpExactly(panorama, view);
}

cv::Mat ViewWarper::warpExactly(const cv::Mat& panorama, const View& view) const {
  const Eigen::Vector3d corner = view.pointAt({0.0, 0.0});
  const Eigen::Vector3d rightward = view.pointAt({1.0, 0.0}) - corner;
  const Eigen::Vector3d downward = view.pointAt({0.0, 1.0}) - corner;
  cv::Mat image(view.size, CV_8UC1);
  for (int j = 0; j < view.size.height; ++j) {
    auto* row = image.ptr<std::uint8_t>(j);
    for (int i = 0; i < view.size.width; ++i) {
      const auto pixel = camera_->pixelFromPoint(corner + i * rightward + j * downward);
      row[i] =
          pixel ? sample(panorama, static_cast<float>(pixel->x()), static_cast<float>(pixel->y()))
                : std::uint8_t{0};
    }
  }
  return image;
}

cv::Mat ViewWarper::warpByTable(const cv::Mat& panorama, const View& view) const {
  const ImagePlane& plane = camera_->imagePlane();
  std::vector<ContourTable::Contours> contours;
  std::vector<Eigen::Vector2d> directions;
  for (int i = 0; i < view.size.width; ++i) {
    const double offset = view.azimuthOffset(i);
    const double azimuth = view.azimuth + offset;
    contours.push_back(table_.contours(offset));
    directions.emplace_back(std::cos(azimuth), std::sin(azimuth));
  }

  cv::Mat image(view.size, CV_8UC1);
  for (int j = 0; j < view.size.height; ++j) {
    const ContourTable::Place radius_main =
        table_.placeOf(table_.imageRadius(view.distance, view.height(j)));
    auto* row = image.ptr<std::uint8_t>(j);
    for (std::size_t i = 0; i < contours.size(); ++i) {
      const auto radius = static_cast<double>(contours[i].radius(radius_main));
      const Eigen::Vector2d pixel = plane.pixelFromIdeal(radius * directions[i]);
      row[i] = sample(panorama, static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    }
  }
  return image;
}

std::optional<Eigen::Vector2d> ViewWarper::panoramaFromView(const View& view,
                                                            const Eigen::Vector2d& position) const {
  if (view.elevation != 0.0) return camera_->pixelFromPoint(view.pointAt(position));
  const double offset = view.azimuthOffset(position.x());
  const double radius_main = table_.imageRadius(view.distance, view.height(position.y()));
  const double radius = table_.radius(radius_main, offset);
  if (std::isnan(radius)) return std::nullopt;
  const double azimuth = view.azimuth + offset;
  const Eigen::Vector2d pixel = camera_->imagePlane().pixelFromIdeal(
      radius * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth)));
  return camera_->isInImage(pixel) ? std::optional(pixel) : std::nullopt;
}

std::optional<Eigen::Vector2d> ViewWarper::viewFromPanorama(const View& view,
                                                            const Eigen::Vector2d& pixel) const {
  if (view.elevation != 0.0) {
    const std::optional<Ray> ray = camera_->rayFromPixel(pixel);
    return ray ? view.positionOf(*ray) : std::nullopt;
  }
  const std::optional<Eigen::Vector2d> ideal = camera_->imagePlane().idealFromPixel(pixel);
  if (!ideal) return std::nullopt;
  const double offset = normalizeAngle(std::atan2(ideal->y(), ideal->x()) - view.azimuth);
  const double radius_main = table_.radiusMain(ideal->norm(), offset);
  if (std::isnan(radius_main)) return std::nullopt;
  return Eigen::Vector2d(view.column(offset), view.row(table_.height(radius_main, view.distance)));
}

}  // namespace omnitag
