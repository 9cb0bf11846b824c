#include "ros/transform_input.h"

#include <cstdint>
#include <exception>

namespace omnitag {
namespace {

/// s of tf to keep, so that images from a long queue still find their transforms.
constexpr double kKept = 30.0;

/// Messages that may wait while a frame is processed: the same time, at a thousand a second.
constexpr std::uint32_t kWaiting = 30000;

/// s: how long a message may be on its way on a busy computer, and how far ahead of the clock a
/// transform from before the clock was set back is.
constexpr double kInFlight = 3.0;
constexpr double kAhead = 1.0;

void logRefused(const std::string& frame, const std::string& publisher, const char* why) {
  constexpr double kLinePeriod = 10.0;  // s
  ROS_ERROR_STREAM_THROTTLE(
      kLinePeriod, "tf: transform of '" << frame << "' from " << publisher << " refused: " << why);
}

}  // namespace

TransformInput::TransformInput(const ros::NodeHandle& node, const FrameNames& frames)
    : node_(node), buffer_(ros::Duration(kKept)), parents_(frames) {
  node_.setCallbackQueue(&queue_);
  // tf2_ros::TransformListener would lose all but the last hundred messages.
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  using Callback = boost::function<void(const Event&)>;
  const Callback take_moving = [this](const Event& event) { take(event, false); };
  const Callback take_static = [this](const Event& event) { take(event, true); };
  subscriber_ = node_.subscribe<tf2_msgs::TFMessage>("/tf", kWaiting, take_moving,
                                                     ros::VoidConstPtr(), hints);
  static_subscriber_ = node_.subscribe<tf2_msgs::TFMessage>("/tf_static", kWaiting, take_static);
}

void TransformInput::serve(double duration) {
  noticeSetBack();
  queue_.callAvailable(ros::WallDuration(duration));
  noticeSetBack();
}

// Transforms from before the clock was set back, as when a bag is played again, would from then on
// seem to be the newest.
void TransformInput::noticeSetBack() {
  const ros::Time now = ros::Time::now();
  if (now < last_served_) {
    buffer_.clear();
    stale_until_ = steadyTime() + kInFlight;
  }
  last_served_ = now;
}

// With such a transform, tf2 would refuse all that are much older until time has caught up.
bool TransformInput::isStale(const ros::Time& stamp) const {
  return steadyTime() < stale_until_ && stamp.toSec() > last_served_.toSec() + kAhead;
}

void TransformInput::take(const Event& event, bool is_static) {
  for (const geometry_msgs::TransformStamped& transform : event.getConstMessage()->transforms) {
    if (!is_static && isStale(transform.header.stamp)) continue;
    try {
      // tf2 itself refuses most invalid transforms, with a line in the log.
      buffer_.setTransform(transform, event.getPublisherName(), is_static);
    } catch (const std::exception& error) {
      logRefused(transform.child_frame_id, event.getPublisherName(), error.what());
    }
    parents_.see(transform, is_static, steadyTime());
  }
}

}  // namespace omnitag
