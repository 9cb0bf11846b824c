#include "ros/parent_watch.h"

#include <utility>

#include "ros/conversions.h"

namespace omnitag {
const std::string& sentFrame(const FrameNames& frames) {
  return frames.odom.empty() ? frames.base : frames.odom;
}

ParentWatch::ParentWatch(const FrameNames& frames)
    : frames_{withoutSlash(frames.map), withoutSlash(frames.odom), withoutSlash(frames.base)} {}

void ParentWatch::see(const geometry_msgs::TransformStamped& transform, bool is_static,
                      double now) {
  const std::string child = withoutSlash(transform.child_frame_id);
  std::string parent = withoutSlash(transform.header.frame_id);
  const bool is_transform = !parent.empty() && parent != child;
  if (!is_transform || child != sentFrame(frames_)) return;
  // The localizer's own transform is never static.
  if (parent == frames_.map && !is_static) return;
  // A static parent stays, whatever else comes and goes.
  if (other_ && other_->is_static && !is_static) return;
  other_ = Parent{std::move(parent), is_static, now};
}

std::optional<std::string> ParentWatch::conflict(double now) const {
  constexpr double kRemembered = 10.0;  // s
  if (!other_ || (!other_->is_static && now - other_->last_seen > kRemembered)) return std::nullopt;
  const std::string& child = sentFrame(frames_);
  const std::string what = "tf has '" + other_->frame + "' as the parent of '" + child +
                           "', and a frame has only one: '" + frames_.map + "' -> '" + child +
                           "' is not sent; ";
  if (!frames_.odom.empty() || other_->frame == frames_.map) {
    return what + "nothing else may be the parent of " +
           (frames_.odom.empty() ? "base_frame" : "odom_frame");
  }
  return what + "set odom_frame to the robot's odometry frame" +
         (other_->is_static ? "" : ", probably '" + other_->frame + "'") +
         ", or base_frame to the robot's root frame" +
         (other_->is_static ? ", probably '" + other_->frame + "'" : "");
}

}  // namespace omnitag
