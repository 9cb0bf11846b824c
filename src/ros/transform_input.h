#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <optional>
#include <string>

#include "ros/clock_watch.h"
#include "ros/parameters.h"
#include "ros/parent_watch.h"

namespace omnitag {

/// The transforms of /tf and /tf_static. They wait until the thread that takes the images asks for
/// them: on a robot they come far more often than images, and each would wake a thread.
class TransformInput {
 public:
  /// Subscribes, but takes nothing before serve(). `frames`: with the map's frame filled in.
  TransformInput(const ros::NodeHandle& node, const FrameNames& frames);
  ~TransformInput() { close(); }
  TransformInput(const TransformInput&) = delete;
  TransformInput& operator=(const TransformInput&) = delete;

  /// Takes what has arrived. If nothing has, waits for at most `duration` (s), or until close().
  void serve(double duration);
  /// What has been taken; may be read by any thread.
  const tf2::BufferCore& buffer() const { return buffer_; }
  /// ParentWatch::conflict() of what has been taken.
  std::optional<std::string> parentConflict() const { return parents_.conflict(steadyTime()); }
  /// Afterwards, nothing more arrives.
  void close() { queue_.disable(); }

 private:
  using Event = ros::MessageEvent<const tf2_msgs::TFMessage>;

  void take(const Event& event, bool is_static);
  void noticeSetBack();
  bool isStale(const ros::Time& stamp) const;

  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  tf2::BufferCore buffer_;
  ParentWatch parents_;
  ros::Subscriber subscriber_;
  ros::Subscriber static_subscriber_;
  ros::Time last_served_;
  /// By steadyTime(): until when transforms from before the clock was set back may still arrive.
  double stale_until_ = 0.0;
};

}  // namespace omnitag
