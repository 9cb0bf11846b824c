#include "room_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

constexpr float kFloor = 120.0F;  // also the ceiling, and where there are no walls
constexpr float kWall = 165.0F;
constexpr float kWhite = 220.0F;
constexpr float kBlack = 30.0F;

Ray operator*(const Eigen::Isometry3d& to_from, const Ray& ray) {
  return {to_from * ray.origin, to_from.linear() * ray.direction};
}

/// A wall is a little lighter here and darker there, in squares of 8 cm.
float texture(std::size_t wall, double along, double height) {
  constexpr double kSquare = 0.08;      // m
  constexpr std::uint32_t kLevels = 9;  // grey
  auto hash = static_cast<std::uint32_t>(wall) * 0x9E3779B1U;
  hash = (hash ^ static_cast<std::uint32_t>(along / kSquare)) * 0x85EBCA6BU;
  hash = (hash ^ (hash >> 13U) ^ static_cast<std::uint32_t>(height / kSquare)) * 0xC2B2AE35U;
  return static_cast<float>((hash >> 16U) % kLevels) - 0.5F * (kLevels - 1);
}

/// Grey level of the wall that a line of sight meets, or of the floor or ceiling before it.
float backgroundAlong(const Ray& ray, const std::vector<Wall>& walls) {
  constexpr double kCeiling = 2.6;  // m
  double nearest = std::numeric_limits<double>::infinity();
  double place = 0.0;
  std::size_t met = 0;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const Eigen::Vector2d along = walls[i].to - walls[i].from;
    const Eigen::Vector2d offset = walls[i].from - ray.origin.head<2>();
    const double turn = ray.direction.x() * along.y() - ray.direction.y() * along.x();
    const double inverse = 1.0 / turn;
    const double distance = (offset.x() * along.y() - offset.y() * along.x()) * inverse;
    const double share =
        (offset.x() * ray.direction.y() - offset.y() * ray.direction.x()) * inverse;
    if (!(distance > 0.0 && distance < nearest && share >= 0.0 && share <= 1.0)) continue;
    nearest = distance;
    place = share;
    met = i;
  }
  const double height = ray.origin.z() + nearest * ray.direction.z();
  if (!(height > 0.0 && height < kCeiling)) return kFloor;
  return kWall + texture(met, place * walls[met].length(), height);
}

/// Grey level of a marker along a line of sight in the marker's frame, and where that meets it.
struct Hit {
  float grey;
  Eigen::Vector3d in_marker;
};

std::optional<Hit> hitAlong(const Ray& ray, const TagPattern& pattern, double module) {
  if (ray.origin.z() <= 0.0 || ray.direction.z() >= 0.0) return std::nullopt;
  const Eigen::Vector3d hit = ray.origin - ray.origin.z() / ray.direction.z() * ray.direction;
  const double half = 0.5 * pattern.width();
  const double column = half + hit.x() / module;
  const double row = half - hit.y() / module;
  const int width = pattern.width();
  if (column < 0.0 || row < 0.0 || column >= width || row >= width) return std::nullopt;
  return Hit{pattern.isWhite(static_cast<int>(column), static_cast<int>(row)) ? kWhite : kBlack,
             hit};
}

}  // namespace

RoomRenderer::RoomRenderer(const MountedCamera& camera, int samples_per_axis)
    : camera_(camera), samples_per_axis_(samples_per_axis) {
  const ImageSize& size = camera.model().imageSize();
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      if (const auto ray = camera.rayInBase({u, v})) sights_.push_back({u, v, *ray});
    }
  }
}

cv::Mat RoomRenderer::render(const MarkerMap& markers, const TagPatterns& patterns,
                             const std::vector<Wall>& walls, const Pose& map_from_base) const {
  const Eigen::Isometry3d isometry = map_from_base.toIsometry();
  const ImageSize& size = camera_.model().imageSize();
  cv::Mat grey(size.height, size.width, CV_32FC1, cv::Scalar(0.0));
  for (const Sight& sight : sights_) {
    grey.at<float>(sight.v, sight.u) = backgroundAlong(isometry * sight.in_base, walls);
  }
  for (const Marker& marker : markers.markers) {
    drawMarker(marker, patterns.of(marker), walls, isometry, &grey);
  }
  cv::Mat image;
  grey.convertTo(image, CV_8UC1);
  return image;
}

void RoomRenderer::drawMarker(const Marker& marker, const TagPattern& pattern,
                              const std::vector<Wall>& walls,
                              const Eigen::Isometry3d& map_from_base, cv::Mat* image) const {
  const double module = marker.size / pattern.widthBetweenCorners();
  const Eigen::Isometry3d marker_from_base = marker.map_from_marker.inverse() * map_from_base;
  const cv::Rect box = boxAround(marker, module * pattern.width(), map_from_base);
  const double step = 1.0 / samples_per_axis_;
  const auto share = static_cast<float>(step * step);
  const auto greyAt = [&](const Eigen::Vector2d& pixel) -> std::optional<float> {
    const auto ray = camera_.tabulatedRayInBase(pixel);
    if (!ray) return std::nullopt;
    const auto hit = hitAlong(marker_from_base * *ray, pattern, module);
    if (!hit) return std::nullopt;
    const Eigen::Vector3d origin = map_from_base * ray->origin;
    const Eigen::Vector3d seen = marker.map_from_marker * hit->in_marker;
    if (isHidden(origin.head<2>(), seen.head<2>(), walls)) return std::nullopt;
    return hit->grey;
  };
  for (int v = box.y; v < box.y + box.height; ++v) {
    for (int u = box.x; u < box.x + box.width; ++u) {
      float& pixel = image->at<float>(v, u);
      const float background = pixel;
      for (int i = 0; i < samples_per_axis_ * samples_per_axis_; ++i) {
        const Eigen::Vector2d offset(i % samples_per_axis_, i / samples_per_axis_);  // NOLINT
        const Eigen::Vector2d sample =
            Eigen::Vector2d(u - 0.5, v - 0.5) + step * (offset + Eigen::Vector2d::Constant(0.5));
        if (const auto seen = greyAt(sample)) pixel += share * (*seen - background);
      }
    }
  }
}

cv::Rect RoomRenderer::boxAround(const Marker& marker, double width,
                                 const Eigen::Isometry3d& map_from_base) const {
  constexpr int kPlacesPerEdge = 8;
  constexpr double kMargin = 2.0;           // pixels
  constexpr double kMarginAtTheRim = 12.0;  // pixels, where only a part of it is within the field
  const Eigen::Vector3d eye = map_from_base * camera_.baseFromCamera().translation();
  constexpr double kMirror = 0.05;  // m, how far from the eye lines of sight begin
  if (marker.normal().dot(eye - marker.center()) < -kMirror) return {};
  Eigen::AlignedBox2d box;
  double margin = kMargin;
  for (int i = 0; i < 4 * kPlacesPerEdge; ++i) {
    const double along = width * ((i % kPlacesPerEdge) / static_cast<double>(kPlacesPerEdge) - 0.5);
    const Eigen::Rotation2Dd turn(0.5 * kPi * (i / kPlacesPerEdge));  // NOLINT
    const Eigen::Vector2d place = turn * Eigen::Vector2d(along, 0.5 * width);
    const auto pixel = camera_.pixelFromMap(
        map_from_base, marker.map_from_marker * Eigen::Vector3d(place.x(), place.y(), 0.0));
    if (pixel) box.extend(*pixel);
    if (!pixel) margin = kMarginAtTheRim;
  }
  if (box.isEmpty()) return {};
  const cv::Point low(cvFloor(box.min().x() - margin), cvFloor(box.min().y() - margin));
  const cv::Point high(cvCeil(box.max().x() + margin), cvCeil(box.max().y() + margin));
  const ImageSize& size = camera_.model().imageSize();
  return cv::Rect(low, high) & cv::Rect(0, 0, size.width, size.height);
}

cv::Mat withGreyNoise(const cv::Mat& image, double deviation, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat noise(image.size(), CV_32FC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, deviation);
  cv::Mat noisy;
  cv::add(image, noise, noisy, cv::noArray(), CV_8UC1);
  return noisy;
}

}  // namespace omnitag
