#include "panorama_renderer.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <cstdlib>
#include <limits>
#include <optional>
#include <stdexcept>

namespace omnitag::test {

TagBitmap tagBitmap(const std::string& family, int id) {
  if (family != "tag36h11") throw std::invalid_argument(family);
  apriltag_family_t* library_family = tag36h11_create();
  image_u8_t* image = apriltag_to_image(library_family, static_cast<uint32_t>(id));
  TagBitmap bitmap{library_family->total_width, library_family->width_at_border, {}};
  for (int row = 0; row < image->height; ++row) {
    for (int column = 0; column < image->width; ++column) {
      bitmap.white.push_back(image->buf[row * image->stride + column] > 127);
    }
  }
  std::free(image->buf);  // as image_u8_destroy, which the library does not export
  std::free(image);
  tag36h11_destroy(library_family);
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

}  // namespace

cv::Mat renderPanorama(const MarkerMap& map, const MountedCamera& camera,
                       const Pose2& map_from_base, int samples_per_axis) {
  std::vector<Board> boards;
  for (const Marker& marker : map.markers) {
    TagBitmap bitmap = tagBitmap(marker.family, marker.id);
    const double module = marker.size / bitmap.width_at_border;
    boards.push_back({marker.map_from_marker.inverse(), module, std::move(bitmap)});
  }
  const ImageSize& size = camera.model().imageSize();
  const Eigen::Isometry3d map_from_camera = camera.mapFromCamera(map_from_base);
  cv::Mat image(size.height, size.width, CV_8UC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      double sum = 0.0;
      for (int i = 0; i < samples_per_axis * samples_per_axis; ++i) {
        const auto offset = [samples_per_axis](int k) {
          return (k + 0.5) / samples_per_axis - 0.5;
        };
        const auto ray = camera.model().rayFromPixel(
            {u + offset(i % samples_per_axis), v + offset(i / samples_per_axis)});
        constexpr double kBackground = 120.0;
        sum += ray ? greyAlong(boards, {map_from_camera * ray->origin,
                                        map_from_camera.linear() * ray->direction})
                         .value_or(kBackground)
                   : 0.0;
      }
      image.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(sum / (samples_per_axis * samples_per_axis));
    }
  }
  return image;
}

}  // namespace omnitag::test
