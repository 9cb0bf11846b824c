#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose2.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/tag_pattern.h"

namespace omnitag {

/// A pixel of a marker as it is and as the pattern would have it.
struct MarkerPixel {
  double grey = 0.0;
  /// Share of white in what the pixel sees of the pattern.
  double white = 0.0;
  /// How much the share of white changes from pixel to pixel.
  double gradient = 0.0;
  /// On the drawing of the tag, whose sides have length 1, from its middle.
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  /// Derivative of `white` by the pose (x, y, yaw), per metre and per radian.
  Eigen::RowVector3d white_by_pose = Eigen::RowVector3d::Zero();
};

/// The part of the panorama that shows a marker, and what the marker's pattern would make of its
/// pixels at a pose.
class MarkerPatch {
 public:
  /// `panorama` (CV_8UC1) and `pattern` must outlive the patch. `map_from_base` says roughly where
  /// the marker images; `blur` is the standard deviation, in pixels, of the blur that adds to the
  /// averaging over a pixel's area.
  MarkerPatch(const cv::Mat& panorama, const Marker& marker, const TagPattern& pattern,
              const MountedCamera& camera, const Pose2& map_from_base, double blur);

  /// The pixels that lie within the drawing at a pose near the one of the constructor.
  std::vector<MarkerPixel> pixels(const Pose2& map_from_base) const;

 private:
  /// Where a line of sight meets the marker, in modules of its drawing, and how that depends on the
  /// pose.
  struct Meeting {
    Eigen::Vector2d position;
    Eigen::Matrix<double, 2, 3> by_pose;
  };

  std::size_t indexOf(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  /// `ray`: turned into the map's axes, but relative to base_link.
  std::optional<Meeting> meet(const Ray& ray, const Eigen::Vector3d& base_in_map) const;
  /// The pixel's area on the marker is the parallelogram of its two sides, in modules. It is cut
  /// into four, each of which is averaged over as if its sides ran along the modules.
  std::optional<MarkerPixel> predict(const Meeting& meeting, Eigen::Vector2d side_u,
                                     Eigen::Vector2d side_v) const;

  const cv::Mat& panorama_;
  const TagPattern& pattern_;
  Eigen::Isometry3d marker_from_map_;
  double modules_per_metre_;
  double blur_variance_;
  int left_ = 0;
  int top_ = 0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::optional<Ray>> rays_;
};

}  // namespace omnitag
