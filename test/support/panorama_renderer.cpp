#include "panorama_renderer.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagStandard41h12.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

namespace omnitag::test {

TagBitmap tagBitmap(const std::string& family, int id) {
  using Create = apriltag_family_t* (*)();
  using Destroy = void (*)(apriltag_family_t*);
  static const std::map<std::string, std::pair<Create, Destroy>> families = {
      {"tag16h5", {tag16h5_create, tag16h5_destroy}},
      {"tag36h11", {tag36h11_create, tag36h11_destroy}},
      {"tagCircle21h7", {tagCircle21h7_create, tagCircle21h7_destroy}},
      {"tagStandard41h12", {tagStandard41h12_create, tagStandard41h12_destroy}},
  };
  const auto [create, destroy] = families.at(family);
  const std::unique_ptr<apriltag_family_t, Destroy> tags(create(), destroy);
  image_u8_t* image = apriltag_to_image(tags.get(), static_cast<uint32_t>(id));
  TagBitmap bitmap{tags->total_width, tags->width_at_border, {}};
  for (int row = 0; row < image->height; ++row) {
    for (int column = 0; column < image->width; ++column) {
      bitmap.white.push_back(image->buf[row * image->stride + column] > 127);
    }
  }
  std::free(image->buf);  // as image_u8_destroy, which the library does not export
  std::free(image);
  return bitmap;
}

namespace {

struct Board {
  Eigen::Isometry3d marker_from_map;
  double module;  // m
  TagBitmap bitmap;
};

/// Grey level of the first board that a ray meets from its front, and how far away that is.
std::optional<double> greyAlong(const std::vector<Board>& boards, const Ray& ray_in_map) {
  double nearest = std::numeric_limits<double>::infinity();
  std::optional<double> grey;
  for (const Board& board : boards) {
    const Eigen::Vector3d origin = board.marker_from_map * ray_in_map.origin;
    const Eigen::Vector3d direction = board.marker_from_map.linear() * ray_in_map.direction;
    if (origin.z() <= 0.0 || direction.z() >= 0.0) continue;
    const double distance = -origin.z() / direction.z();
    const Eigen::Vector3d hit = origin + distance * direction;
    const double half = 0.5 * board.bitmap.total_width;
    const double column = hit.x() / board.module + half;
    const double row = half - hit.y() / board.module;
    const int width = board.bitmap.total_width;
    if (column < 0 || row < 0 || column >= width || row >= width || distance >= nearest) continue;
    nearest = distance;
    const auto index =
        static_cast<std::size_t>(static_cast<int>(row) * width + static_cast<int>(column));
    grey = board.bitmap.white[index] ? 220.0 : 30.0;
  }
  return grey;
}

/// What a line of sight shows: nothing of the world, the background or a board.
struct Sight {
  enum Kind : std::uint8_t { kNothing, kBackground, kBoard };
  Kind kind = kNothing;
  double grey = 0.0;
};

}  // namespace

cv::Mat renderPanorama(const MarkerMap& map, const MountedCamera& camera, const Pose& map_from_base,
                       int samples_per_axis) {
  std::vector<Board> boards;
  for (const Marker& marker : map.markers) {
    TagBitmap bitmap = tagBitmap(marker.family, marker.id);
    const double module = marker.size / bitmap.width_at_border;
    boards.push_back({marker.map_from_marker.inverse(), module, std::move(bitmap)});
  }
  const Eigen::Isometry3d isometry = map_from_base.toIsometry();
  const auto look = [&](double u, double v) -> Sight {
    const auto ray = camera.rayInBase({u, v});
    if (!ray) return {};
    constexpr double kBackground = 120.0;
    const auto grey =
        greyAlong(boards, {isometry * ray->origin, isometry.linear() * ray->direction});
    return {grey ? Sight::kBoard : Sight::kBackground, grey.value_or(kBackground)};
  };

  const ImageSize& size = camera.model().imageSize();
  cv::Mat image(size.height, size.width, CV_8UC1);
  cv::Mat kinds(size.height, size.width, CV_8UC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const Sight sight = look(u, v);
      image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(sight.grey);
      kinds.at<std::uint8_t>(v, u) = sight.kind;
    }
  }
  // A pixel whose middle and whose neighbours' middles show the background shows nothing else.
  const auto isEven = [&](int u, int v) {
    for (int row = std::max(0, v - 1); row <= std::min(size.height - 1, v + 1); ++row) {
      for (int column = std::max(0, u - 1); column <= std::min(size.width - 1, u + 1); ++column) {
        const std::uint8_t kind = kinds.at<std::uint8_t>(row, column);
        if (kind == Sight::kBoard || kind != kinds.at<std::uint8_t>(v, u)) return false;
      }
    }
    return true;
  };
  const auto offset = [samples_per_axis](int k) { return (k + 0.5) / samples_per_axis - 0.5; };
  const int samples = samples_per_axis * samples_per_axis;
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      if (isEven(u, v)) continue;
      double sum = 0.0;
      for (int i = 0; i < samples; ++i) {
        sum += look(u + offset(i % samples_per_axis), v + offset(i / samples_per_axis)).grey;
      }
      image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(sum / samples);
    }
  }
  return image;
}

}  // namespace omnitag::test
