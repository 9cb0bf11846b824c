#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/tag_pattern.h"
#include "room.h"

namespace omnitag {

/// Draws what a camera on a robot sees of a room: grey walls, darker floor and ceiling, and the
/// markers that no wall hides. Without light, blur and noise, and thus in milliseconds.
class RoomRenderer {
 public:
  /// The mean of `samples_per_axis` squared lines of sight is taken in pixels of markers.
  explicit RoomRenderer(const MountedCamera& camera, int samples_per_axis = 3);

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
  void drawMarker(const Marker& marker, const TagPattern& pattern, const std::vector<Wall>& walls,
                  const Eigen::Isometry3d& map_from_base, cv::Mat* image) const;
  /// Pixels that may show some of a marker's drawing, so wide (m); none where it is out of sight.
  cv::Rect boxAround(const Marker& marker, double width,
                     const Eigen::Isometry3d& map_from_base) const;

  MountedCamera camera_;
  int samples_per_axis_;
  std::vector<Sight> sights_;
};

/// The image with noise of this standard deviation (grey levels), the same for the same seed.
cv::Mat withGreyNoise(const cv::Mat& image, double deviation, std::uint64_t seed);

}  // namespace omnitag
