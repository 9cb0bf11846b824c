#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <set>
#include <string>
#include <utility>

#include "omnitag/marker/marker_map.h"
#include "ros/image_localizer.h"

namespace omnitag {

/// What RViz shows of each image: the robot, where markers were expected and seen, and how
/// uncertain the pose is. Each kind has its own namespace, so that RViz can hide it: `robot`;
/// `predicted`, `accepted` and `rejected`, lines from the camera to the markers; `reasons` of the
/// rejections; `covariance`, the true 3-sigma ellipse of the position with its size in words;
/// `covariance_enlarged`, the same ellipse if the true one is too small to be seen; `hypotheses`,
/// arrows with their probabilities if the robot may be at several poses; `remark`, why there is no
/// pose. If there are several cameras, namespaces of what a camera sees end with its name:
/// `accepted front`.
class FrameMarkers {
 public:
  /// `robot_radius`: m, of the cylinder that represents the robot.
  FrameMarkers(std::string map_frame, double robot_radius);

  /// Draws one image and deletes what is left of the previous one.
  visualization_msgs::MarkerArray draw(const LocalizedImage& localized, const MarkerMap& map);

 private:
  std::string map_frame_;
  double robot_radius_;
  std::set<std::pair<std::string, int>> shown_;
};

}  // namespace omnitag
