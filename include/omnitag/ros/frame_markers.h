#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <set>
#include <string>
#include <utility>

#include "omnitag/marker/marker_map.h"
#include "omnitag/ros/image_localizer.h"

namespace omnitag {

/// What RViz shows of each image: the robot, where markers were expected and seen, and how far the
/// pose can be trusted. Each kind has a namespace of its own, so that RViz can hide it:
/// `robot`; `predicted`, `accepted` and `rejected` lines from the camera to the markers; `reasons`
/// of the rejections; `covariance`, the true 3-sigma ellipse of the position with its size in
/// words; `covariance_enlarged`, the same ellipse where the true one is too small to be seen;
/// `hypotheses`, arrows with their probabilities where the robot may be at several poses.
class FrameMarkers {
 public:
  /// `robot_radius`: m, of the body that stands for the robot.
  FrameMarkers(std::string map_frame, double robot_radius);

  /// Draws one image, and removes what the one before left.
  visualization_msgs::MarkerArray draw(const LocalizedImage& localized, const MarkerMap& map);

 private:
  std::string map_frame_;
  double robot_radius_;
  std::set<std::pair<std::string, int>> shown_;
};

}  // namespace omnitag
