#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <memory>

namespace omnitag {

/// The transforms of /tf and /tf_static. They wait until the thread that takes the images asks for
/// them: on a robot, they come far more often than images, and each would wake a thread.
class TransformInput {
 public:
  /// Subscribes; nothing is taken before serve().
  explicit TransformInput(const ros::NodeHandle& node);
  ~TransformInput() { close(); }
  TransformInput(const TransformInput&) = delete;
  TransformInput& operator=(const TransformInput&) = delete;

  /// Takes what has come; waits for it where nothing has, but no longer than so many s nor than to
  /// close().
  void serve(double duration);
  /// What has been taken. May be read by any thread.
  const tf2_ros::Buffer& buffer() const { return buffer_; }
  /// Nothing comes any more.
  void close() { queue_.disable(); }

 private:
  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  tf2_ros::Buffer buffer_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;
  ros::Time last_served_;
};

}  // namespace omnitag
