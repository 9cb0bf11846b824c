#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "marker/tag_pattern.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "room.h"

namespace omnitag {

/// Draws what a camera on a robot sees of a room: grey walls, darker floor and ceiling, and the
/// markers that no wall hides. Without light, blur and noise, and thus in milliseconds.
class RoomRenderer {
 public:
  /// The mean of `samples_per_axis` squared places is taken in pixels of markers, between the lines
  /// of sight of the pixels' corners. Fewer leave edges more noisy than the image.
  explicit RoomRenderer(const MountedCamera& camera, int samples_per_axis = 8);

  /// CV_8UC1. `patterns`: those of the markers.
  cv::Mat render(const MarkerMap& markers, const TagPatterns& patterns,
                 const std::vector<Wall>& walls, const Pose& map_from_base) const;

 private:
  /// One pixel that shows the world.
  struct Sight {
    int u;
    int v;
    Ray in_base;
  };
  /// Where the line of sight of a pixel's corner meets the plane of a marker's drawing.
  struct Hit {
    bool is_there = false;
    bool is_hidden = false;
    /// m, in the map: where the line begins, and where it meets the plane.
    Eigen::Vector2d eye = Eigen::Vector2d::Zero();
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    /// Column and row in the drawing, in modules.
    Eigen::Vector2d module = Eigen::Vector2d::Zero();
  };
  void drawMarker(const Marker& marker, const TagPattern& pattern, const std::vector<Wall>& walls,
                  const Eigen::Isometry3d& map_from_base, cv::Mat* image) const;
  /// By the corner's column and row: the upper left one of the pixel of the same.
  Hit hitOf(int column, int row, const Marker& marker, const TagPattern& pattern,
            const std::vector<Wall>& walls, const Eigen::Isometry3d& map_from_base) const;
  /// Grey level of a pixel by the hits of its corners: upper left, upper right, lower left, lower
  /// right.
  float greyBetween(const std::array<Hit, 4>& hits, const TagPattern& pattern,
                    const std::vector<Wall>& walls, float background) const;
  /// Pixels that may show some of a marker's drawing, so wide (m); none where it is out of sight.
  cv::Rect boxAround(const Marker& marker, double width,
                     const Eigen::Isometry3d& map_from_base) const;

  MountedCamera camera_;
  int samples_per_axis_;
  std::vector<Sight> sights_;
  /// In base_link, of the pixels' corners, row by row.
  std::vector<std::optional<Ray>> corners_;
};

/// The image with noise of this standard deviation (grey levels), the same for the same seed.
cv::Mat withGreyNoise(const cv::Mat& image, double deviation, std::uint64_t seed);

}  // namespace omnitag
