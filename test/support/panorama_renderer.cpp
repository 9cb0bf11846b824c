#include "panorama_renderer.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagStandard41h12.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "marker/pattern_picture.h"

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
  std::free(image->buf);  // as image_u8_destroy does, which the library does not export
  std::free(image);
  return bitmap;
}

namespace {

/// What is printed on a board, row by row: the share of white of its modules.
struct Print {
  int width = 0;
  std::vector<double> white;
};

struct Board {
  Eigen::Isometry3d marker_from_map;
  double module;  // m
  Print print;
  std::array<double, 3> center;  // m, in the map
  double square_radius;          // m^2, of the sphere that holds it
};

/// A picture within a black and a white border. `border`: cells.
Print printOf(const PatternPicture& picture, int border) {
  const int white_border = border / 2;
  const int before = border + white_border;
  Print print;
  print.width = picture.side + 2 * before;
  for (int row = 0; row < print.width; ++row) {
    for (int column = 0; column < print.width; ++column) {
      const int from_edge =
          std::min({row, column, print.width - 1 - row, print.width - 1 - column});
      const bool is_picture = from_edge >= before;
      const double around = from_edge < white_border ? 1.0 : 0.0;
      print.white.push_back(is_picture ? picture.whiteAt(column - before, row - before) : around);
    }
  }
  return print;
}

Board boardOf(const Marker& marker) {
  double module = 0.0;
  Print print;
  if (marker.picture) {
    const double cells = marker.picture->side / (1.0 - 2.0 * marker.picture->border);
    module = marker.size / cells;
    print = printOf(*marker.picture, static_cast<int>(std::lround(marker.picture->border * cells)));
  } else {
    const TagBitmap bitmap = tagBitmap(marker.family, marker.id);
    module = marker.size / bitmap.width_at_border;
    print = {bitmap.total_width, {bitmap.white.begin(), bitmap.white.end()}};
  }
  const double edge = module * print.width;
  const Eigen::Vector3d center = marker.center();
  return {marker.map_from_marker.inverse(),
          module,
          std::move(print),
          {center.x(), center.y(), center.z()},
          0.51 * edge * edge};
}

/// Whether a ray's line passes through the sphere that holds a board; few do. In plain numbers,
/// which sanitizers slow down less.
bool isAimedAt(const Board& board, const double* origin, const double* direction) {
  const double x = board.center[0] - origin[0];
  const double y = board.center[1] - origin[1];
  const double z = board.center[2] - origin[2];
  const double dx = direction[0];
  const double dy = direction[1];
  const double dz = direction[2];
  const double a = y * dz - z * dy;
  const double b = z * dx - x * dz;
  const double c = x * dy - y * dx;
  return a * a + b * b + c * c <= board.square_radius * (dx * dx + dy * dy + dz * dz);
}

constexpr double kBackgroundGrey = 120.0;

/// Grey level of the first board that a ray meets from its front.
std::optional<double> greyAlong(const std::vector<Board>& boards, const Ray& ray_in_map) {
  double nearest = std::numeric_limits<double>::infinity();
  std::optional<double> grey;
  for (const Board& board : boards) {
    if (!isAimedAt(board, ray_in_map.origin.data(), ray_in_map.direction.data())) continue;
    const Eigen::Vector3d origin = board.marker_from_map * ray_in_map.origin;
    const Eigen::Vector3d direction = board.marker_from_map.linear() * ray_in_map.direction;
    if (origin.z() <= 0.0 || direction.z() >= 0.0) continue;
    const double distance = -origin.z() / direction.z();
    const Eigen::Vector3d hit = origin + distance * direction;
    const double half = 0.5 * board.print.width;
    const double column = hit.x() / board.module + half;
    const double row = half - hit.y() / board.module;
    const int width = board.print.width;
    if (column < 0 || row < 0 || column >= width || row >= width || distance >= nearest) continue;
    nearest = distance;
    const auto index =
        static_cast<std::size_t>(static_cast<int>(row) * width + static_cast<int>(column));
    grey = 30.0 + 190.0 * board.print.white[index];
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
                       int samples_per_axis, const cv::Range& rows) {
  std::vector<Board> boards;
  for (const Marker& marker : map.markers) boards.push_back(boardOf(marker));
  const Eigen::Isometry3d isometry = map_from_base.toIsometry();
  const auto look = [&](double u, double v) -> Sight {
    const auto ray = camera.rayInBase({u, v});
    if (!ray) return {};
    const auto grey =
        greyAlong(boards, {isometry * ray->origin, isometry.linear() * ray->direction});
    return {grey ? Sight::kBoard : Sight::kBackground, grey.value_or(kBackgroundGrey)};
  };

  const ImageSize& size = camera.model().imageSize();
  // What the middle of each pixel shows, looked up on first use.
  std::vector<std::optional<Sight::Kind>> kinds(static_cast<std::size_t>(size.width) *
                                                static_cast<std::size_t>(size.height));
  const auto kindAt = [&](int u, int v) {
    std::optional<Sight::Kind>& kind = kinds[static_cast<std::size_t>(v * size.width + u)];
    if (!kind) kind = look(u, v).kind;
    return *kind;
  };
  // Whether the middles of all pixels (or every second one, by `step`) within `distance` show the
  // same as this one's, and no board.
  const auto isEven = [&](int u, int v, int distance, int step) {
    const Sight::Kind kind = kindAt(u, v);
    if (kind == Sight::kBoard) return false;
    for (int down = -distance; down <= distance; down += step) {
      for (int right = -distance; right <= distance; right += step) {
        const int column = std::clamp(u + right, 0, size.width - 1);
        const int row = std::clamp(v + down, 0, size.height - 1);
        if (kindAt(column, row) != kind) return false;
      }
    }
    return true;
  };
  const auto greyOf = [](Sight::Kind kind) {
    return kind == Sight::kBackground ? kBackgroundGrey : 0.0;
  };
  const auto offset = [samples_per_axis](int k) { return (k + 0.5) / samples_per_axis - 0.5; };
  const auto greyAt = [&](int u, int v) {
    if (isEven(u, v, 1, 1)) return greyOf(kindAt(u, v));
    const int samples = samples_per_axis * samples_per_axis;
    double sum = 0.0;
    for (int i = 0; i < samples; ++i) {
      sum += look(u + offset(i % samples_per_axis), v + offset(i / samples_per_axis)).grey;
    }
    return sum / samples;
  };

  cv::Mat image = cv::Mat::zeros(size.height, size.width, CV_8UC1);
  const int first = std::max(0, rows.start);
  const int end = std::min(size.height, rows.end);
  // In blocks of two by two, most of which show nothing but the background.
  for (int top = first - first % 2; top < end; top += 2) {
    for (int left = 0; left < size.width; left += 2) {
      const bool is_even = isEven(left, top, 4, 2);
      for (int v = std::max(first, top); v < std::min(end, top + 2); ++v) {
        for (int u = left; u < std::min(size.width, left + 2); ++u) {
          const double grey = is_even ? greyOf(kindAt(left, top)) : greyAt(u, v);
          image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(grey);
        }
      }
    }
  }
  return image;
}

}  // namespace omnitag::test
