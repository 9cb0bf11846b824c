#include "pattern_pixels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace omnitag {
namespace {

/// A point of the marker in the image and how it moves with what is unknown.
struct MovingPoint {
  Eigen::Vector2d pixel;
  FrameJacobian by_frame;
};

/// The rectangle of the image around a marker's drawing, and what is in its pixels.
class Accumulation {
 public:
  Accumulation(const Eigen::Vector2d& low, const Eigen::Vector2d& high)
      : left_(static_cast<int>(std::floor(low.x()))),
        top_(static_cast<int>(std::floor(low.y()))),
        columns_(static_cast<int>(std::ceil(high.x())) + 1 - left_),
        rows_(static_cast<int>(std::ceil(high.y())) + 1 - top_),
        swept_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_),
               FrameVector::Zero()) {}

  int left() const { return left_; }
  int top() const { return top_; }
  int right() const { return left_ + columns_; }
  int bottom() const { return top_ + rows_; }

  FrameVector& sweptAt(int u, int v) {
    return swept_[static_cast<std::size_t>(v - top_) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(u - left_)];
  }

 private:
  int left_;
  int top_;
  int columns_;
  int rows_;
  /// White area that a change of the unknowns adds.
  std::vector<FrameVector> swept_;
};

/// A marker's drawing before a camera. Positions on it are TagPattern's: modules, y down.
class Drawing {
 public:
  Drawing(const MountedCamera& camera, const Pose& map_from_base, const Marker& marker,
          const TagPattern& pattern)
      : camera_(camera),
        map_from_base_(map_from_base.toIsometry()),
        map_from_marker_(marker.map_from_marker),
        pattern_(pattern),
        module_(marker.size / pattern.widthBetweenCorners()),
        marker_from_base_(marker.map_from_marker.inverse() * map_from_base_) {}

  std::optional<MovingPoint> project(const Eigen::Vector2d& position) const {
    MovingPoint moving;
    const auto pixel = camera_.pixelFromMap(map_from_base_, inMap(position), &moving.by_frame);
    if (!pixel) return std::nullopt;
    moving.pixel = *pixel;
    return moving;
  }

  /// Share of white of a pixel, from a grid of points; nothing where it shows anything else than
  /// the drawing. Within a pixel, places on the drawing are interpolated between its corners.
  std::optional<double> white(int u, int v, int samples) const {
    const auto upper_left = placeAt({u - 0.5, v - 0.5});
    const auto upper_right = placeAt({u + 0.5, v - 0.5});
    const auto lower_left = placeAt({u - 0.5, v + 0.5});
    const auto lower_right = placeAt({u + 0.5, v + 0.5});
    if (!upper_left || !upper_right || !lower_left || !lower_right) return std::nullopt;
    double white = 0.0;
    for (int row = 0; row < samples; ++row) {
      const double down = (row + 0.5) / samples;
      const Eigen::Vector2d left = (1.0 - down) * *upper_left + down * *lower_left;
      const Eigen::Vector2d right = (1.0 - down) * *upper_right + down * *lower_right;
      for (int column = 0; column < samples; ++column) {
        const Eigen::Vector2d place = left + (column + 0.5) / samples * (right - left);
        white += pattern_.whiteAt(static_cast<int>(place.x()), static_cast<int>(place.y()));
      }
    }
    return white / (samples * samples);
  }

 private:
  /// Where on the drawing a pixel position lies.
  std::optional<Eigen::Vector2d> placeAt(const Eigen::Vector2d& pixel) const {
    const std::optional<Ray> ray = camera_.rayInBase(pixel);
    if (!ray) return std::nullopt;
    const Eigen::Vector3d origin = marker_from_base_ * ray->origin;
    const Eigen::Vector3d direction = marker_from_base_.linear() * ray->direction;
    if (origin.z() <= 0.0 || direction.z() >= 0.0) return std::nullopt;
    const Eigen::Vector3d place = (origin - origin.z() / direction.z() * direction) / module_;
    const Eigen::Vector2d position(middle() + place.x(), middle() - place.y());
    const bool is_inside = position.minCoeff() > 0.0 && position.maxCoeff() < pattern_.width();
    return is_inside ? std::optional(position) : std::nullopt;
  }

  double middle() const { return 0.5 * pattern_.width(); }

  Eigen::Vector3d inMap(const Eigen::Vector2d& position) const {
    return map_from_marker_ * Eigen::Vector3d(module_ * (position.x() - middle()),
                                              module_ * (middle() - position.y()), 0.0);
  }

  const MountedCamera& camera_;
  Eigen::Isometry3d map_from_base_;
  Eigen::Isometry3d map_from_marker_;
  const TagPattern& pattern_;
  double module_;
  Eigen::Isometry3d marker_from_base_;
};

/// Shares what a piece of outline sweeps out among the pixels that it runs through. White is to
/// its left, in image coordinates, if `orientation` is 1, to its right if it is -1.
void sweep(const MovingPoint& from, const MovingPoint& to, double orientation,
           Accumulation* accumulation) {
  constexpr double kPiecesPerPixel = 64.0;
  const Eigen::Vector2d way = to.pixel - from.pixel;
  const int pieces = static_cast<int>(std::ceil(kPiecesPerPixel * way.norm())) + 1;
  const Eigen::Vector2d piece = way / pieces;
  const FrameJacobian by_frame = 0.5 * (from.by_frame + to.by_frame);
  const FrameVector white_by_frame =
      orientation * (by_frame.row(0) * piece.y() - by_frame.row(1) * piece.x()).transpose();
  for (int i = 0; i < pieces; ++i) {
    const Eigen::Vector2d pixel = from.pixel + (i + 0.5) * piece;
    accumulation->sweptAt(static_cast<int>(std::lround(pixel.x())),
                          static_cast<int>(std::lround(pixel.y()))) += white_by_frame;
  }
}

/// Sweeps an edge between two modules, from one of their common corners to the other.
bool sweepEdge(const Drawing& drawing, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
               double orientation, Accumulation* accumulation) {
  constexpr int kParts = 4;
  std::optional<MovingPoint> last = drawing.project(from);
  for (int i = 1; i <= kParts; ++i) {
    const std::optional<MovingPoint> next = drawing.project(from + (to - from) * i / kParts);
    if (!last || !next) return false;
    sweep(*last, *next, orientation, accumulation);
    last = next;
  }
  return true;
}

/// All edges between black and white; false where the camera does not see one.
bool sweepEdges(const Drawing& drawing, const TagPattern& pattern, double orientation,
                Accumulation* accumulation) {
  const int width = pattern.width();
  for (int row = 0; row < width; ++row) {
    for (int column = 0; column < width; ++column) {
      const double white = pattern.whiteAt(column, row);
      const auto stepTo = [&](int next_column, int next_row) {
        return orientation * (white - pattern.whiteAt(next_column, next_row));
      };
      // Of coordinates with y down, left of the way up is the lesser x, left of the way to the
      // right the lesser y turned over: the signs below are those of x to the right and y down.
      const double right = column + 1 < width ? stepTo(column + 1, row) : 0.0;
      if (right != 0.0 && !sweepEdge(drawing, {column + 1.0, row + 0.0}, {column + 1.0, row + 1.0},
                                     right, accumulation)) {
        return false;
      }
      const double down = row + 1 < width ? stepTo(column, row + 1) : 0.0;
      if (down != 0.0 && !sweepEdge(drawing, {column + 0.0, row + 1.0}, {column + 1.0, row + 1.0},
                                    -down, accumulation)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

std::vector<PatternPixel> patternPixels(const cv::Mat& image, const MountedCamera& camera,
                                        const Pose& map_from_base, const Marker& marker,
                                        const TagPattern& pattern, int samples) {
  constexpr int kManySamples = 32;
  const Drawing drawing(camera, map_from_base, marker, pattern);
  const double width = pattern.width();
  Eigen::Vector2d low(image.cols, image.rows);
  Eigen::Vector2d high(0.0, 0.0);
  std::array<Eigen::Vector2d, 4> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto corner = drawing.project({i % 2 == 0 ? 0.0 : width, i < 2 ? 0.0 : width});
    if (!corner) return {};
    corners[i] = corner->pixel;
  }
  constexpr int kParts = 8;
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; j <= kParts; ++j) {
      const auto point = drawing.project({width * i / kParts, width * j / kParts});
      if (!point) return {};
      low = low.cwiseMin(point->pixel);
      high = high.cwiseMax(point->pixel);
    }
  }
  Accumulation accumulation(low - Eigen::Vector2d::Ones(), high + Eigen::Vector2d::Ones());
  const Eigen::Vector2d along_x = corners[1] - corners[0];
  const Eigen::Vector2d along_y = corners[2] - corners[0];
  const double turn = along_x.x() * along_y.y() - along_x.y() * along_y.x();
  if (!sweepEdges(drawing, pattern, turn > 0.0 ? 1.0 : -1.0, &accumulation)) return {};

  const Eigen::Vector2d middle = 0.5 * (low + high);
  const Eigen::Vector2d half_size = 0.5 * (high - low);
  std::vector<PatternPixel> pixels;
  for (int v = std::max(accumulation.top(), 0); v < std::min(accumulation.bottom(), image.rows);
       ++v) {
    for (int u = std::max(accumulation.left(), 0); u < std::min(accumulation.right(), image.cols);
         ++u) {
      const std::optional<double> white = drawing.white(u, v, kManySamples);
      if (!white) continue;
      PatternPixel pixel;
      pixel.white = *white;
      pixel.white_by_frame = accumulation.sweptAt(u, v);
      pixel.offset = (Eigen::Vector2d(u, v) - middle).cwiseQuotient(half_size);
      pixel.grey = image.at<std::uint8_t>(v, u);
      pixel.sampled_white = *drawing.white(u, v, samples);
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

}  // namespace omnitag
