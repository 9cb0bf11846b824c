#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Path.h>

#include <cstddef>

namespace omnitag {

/// Where the robot has been: poses at least a step apart. The oldest are forgotten.
class PathRecorder {
 public:
  /// `min_step`: m; `max_poses`: at least 1.
  PathRecorder(double min_step, int max_poses);

  /// Adds the pose if it is far enough from the last one; returns whether it was.
  bool add(const geometry_msgs::PoseStamped& pose);
  void clear() { path_.poses.clear(); }

  const nav_msgs::Path& path() const { return path_; }

 private:
  double min_step_;
  std::size_t max_poses_;
  nav_msgs::Path path_;
};

}  // namespace omnitag
