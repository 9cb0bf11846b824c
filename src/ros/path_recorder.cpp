#include "ros/path_recorder.h"

#include <cmath>

namespace omnitag {

PathRecorder::PathRecorder(double min_step, int max_poses)
    : min_step_(min_step), max_poses_(static_cast<std::size_t>(max_poses)) {}

bool PathRecorder::add(const geometry_msgs::PoseStamped& pose) {
  if (!path_.poses.empty()) {
    const geometry_msgs::Point& last = path_.poses.back().pose.position;
    const geometry_msgs::Point& next = pose.pose.position;
    if (std::hypot(next.x - last.x, next.y - last.y) < min_step_) return false;
  }
  // Erases half of them at once, because erasing at the front moves all that remain.
  if (path_.poses.size() == max_poses_) {
    const auto kept = static_cast<std::ptrdiff_t>(max_poses_ / 2);
    path_.poses.erase(path_.poses.begin(), path_.poses.end() - kept);
  }
  path_.header = pose.header;
  path_.poses.push_back(pose);
  return true;
}

}  // namespace omnitag
