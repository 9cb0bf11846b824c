#include "omnitag/ros/parent_watch.h"

namespace omnitag {
namespace {

/// As tf2 compares them.
std::string withoutSlash(const std::string& name) {
  return !name.empty() && name.front() == '/' ? name.substr(1) : name;
}

}  // namespace

const std::string& sentFrame(const FrameNames& frames) {
  return frames.odom.empty() ? frames.base : frames.odom;
}

ParentWatch::ParentWatch(const FrameNames& frames) : frames_(frames) {}

void ParentWatch::see(const geometry_msgs::TransformStamped& transform, bool is_static,
                      double now) {
  if (withoutSlash(transform.child_frame_id) != sentFrame(frames_)) return;
  std::string parent = withoutSlash(transform.header.frame_id);
  if (parent == frames_.map) return;
  // What is static stays, whatever else comes and goes.
  if (other_ && other_->is_static && !is_static) return;
  other_ = Parent{std::move(parent), is_static, now};
}

std::optional<std::string> ParentWatch::conflict(double now) const {
  constexpr double kRemembered = 10.0;  // s
  if (!other_ || (!other_->is_static && now - other_->last_seen > kRemembered)) return std::nullopt;
  const std::string& child = sentFrame(frames_);
  const std::string what = "tf has '" + other_->frame + "' as the parent of '" + child + "': '" +
                           frames_.map + "' -> '" + child +
                           "' is not sent, as a frame has one parent; ";
  if (!frames_.odom.empty()) {
    return what + "expected odom_frame to have none: stop what else localizes the robot";
  }
  return what + "set odom_frame to the robot's odometry frame" +
         (other_->is_static ? ", or base_frame to '" + other_->frame + "'"
                            : ", as '" + other_->frame + "'");
}

}  // namespace omnitag
