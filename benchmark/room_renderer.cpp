#include "room_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "common/grid_index.h"
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

/// Of four values at the corners of a square, the one at a place in it.
Eigen::Vector2d between(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                        const Eigen::Vector2d& c, const Eigen::Vector2d& d, double right,
                        double down) {
  return (1.0 - down) * ((1.0 - right) * a + right * b) + down * ((1.0 - right) * c + right * d);
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
  for (int v = 0; v <= size.height; ++v) {
    for (int u = 0; u <= size.width; ++u) corners_.push_back(camera.rayInBase({u - 0.5, v - 0.5}));
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
  const double width = marker.size / pattern.widthBetweenCorners() * pattern.width();
  const cv::Rect box = boxAround(marker, width, map_from_base);
  const auto hitsOfRow = [&](int row) {
    std::vector<Hit> hits;
    for (int column = box.x; column <= box.x + box.width; ++column) {
      hits.push_back(hitOf(column, row, marker, pattern, walls, map_from_base));
    }
    return hits;
  };
  std::vector<Hit> upper = hitsOfRow(box.y);
  for (int v = box.y; v < box.y + box.height; ++v) {
    std::vector<Hit> lower = hitsOfRow(v + 1);
    for (std::size_t i = 0; i + 1 < upper.size(); ++i) {
      float& pixel = image->at<float>(v, box.x + static_cast<int>(i));
      pixel = greyBetween({upper[i], upper[i + 1], lower[i], lower[i + 1]}, pattern, walls, pixel);
    }
    upper = std::move(lower);
  }
}

RoomRenderer::Hit RoomRenderer::hitOf(int column, int row, const Marker& marker,
                                      const TagPattern& pattern, const std::vector<Wall>& walls,
                                      const Eigen::Isometry3d& map_from_base) const {
  const int columns = camera_.model().imageSize().width + 1;
  const std::optional<Ray>& in_base = corners_[gridIndex(column, row, columns)];
  if (!in_base) return {};
  const Ray in_map = map_from_base * *in_base;
  const Ray ray = marker.map_from_marker.inverse() * in_map;
  if (ray.origin.z() <= 0.0 || ray.direction.z() >= 0.0) return {};
  const double distance = -ray.origin.z() / ray.direction.z();
  const Eigen::Vector3d place = ray.origin + distance * ray.direction;
  const double modules_per_metre = pattern.widthBetweenCorners() / marker.size;
  Hit hit;
  hit.is_there = true;
  hit.eye = in_map.origin.head<2>();
  hit.place = (in_map.origin + distance * in_map.direction).head<2>();
  hit.is_hidden = isHidden(hit.eye, hit.place, walls);
  hit.module = Eigen::Vector2d::Constant(0.5 * pattern.width()) +
               modules_per_metre * Eigen::Vector2d(place.x(), -place.y());
  return hit;
}

float RoomRenderer::greyBetween(const std::array<Hit, 4>& hits, const TagPattern& pattern,
                                const std::vector<Wall>& walls, float background) const {
  const auto isHit = [](const Hit& hit) { return hit.is_there; };
  const auto isBehind = [](const Hit& hit) { return hit.is_hidden; };
  if (!std::all_of(hits.begin(), hits.end(), isHit)) return background;
  if (std::all_of(hits.begin(), hits.end(), isBehind)) return background;
  const bool is_partly_hidden = std::any_of(hits.begin(), hits.end(), isBehind);
  const auto& [a, b, c, d] = hits;
  const double step = 1.0 / samples_per_axis_;
  float sum = 0.0F;
  for (int i = 0; i < samples_per_axis_; ++i) {
    const double down = (i + 0.5) * step;
    for (int k = 0; k < samples_per_axis_; ++k) {
      const double right = (k + 0.5) * step;
      const Eigen::Vector2d module = between(a.module, b.module, c.module, d.module, right, down);
      if (module.minCoeff() < 0.0 || module.maxCoeff() >= pattern.width()) continue;
      if (is_partly_hidden &&
          isHidden(between(a.eye, b.eye, c.eye, d.eye, right, down),
                   between(a.place, b.place, c.place, d.place, right, down), walls)) {
        continue;
      }
      const double white =
          pattern.whiteAt(static_cast<int>(module.x()), static_cast<int>(module.y()));
      sum += kBlack + static_cast<float>(white) * (kWhite - kBlack) - background;
    }
  }
  return background + sum * static_cast<float>(step * step);
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
