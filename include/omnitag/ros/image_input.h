#pragma once

#include <cv_bridge/cv_bridge.h>
#include <image_transport/image_transport.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/Header.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

namespace omnitag {

/// An image that came in, not decoded yet.
struct ReceivedImage {
  std_msgs::Header header;
  /// Throws InputError where the message is no image.
  std::function<cv_bridge::CvImageConstPtr()> decode;
};

/// Subscribes to images and hands them on one by one, to one thread. Of those that wait, the oldest
/// give way to newer ones, and are counted: what this process received and dropped is known
/// exactly, but for images that come while the thread stays away for more than a second. What the
/// network or the sender dropped is not, since neither stamps nor sequence numbers tell.
///
/// Messages come on a queue of its own, which that thread serves itself: a nodelet manager would
/// wake two threads of its own for each message before this one.
class ImageInput {
 public:
  /// Subscribes to `image` by image_transport. `compressed` is decoded here, so that it needs no
  /// plugin. Throws InputError for a transport that cannot be loaded.
  ImageInput(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
             const std::string& transport, int queue_size);
  ~ImageInput() { close(); }
  ImageInput(const ImageInput&) = delete;
  ImageInput& operator=(const ImageInput&) = delete;

  /// The next image, if there is one: where none waits, serves the queue as serve() does.
  std::optional<ReceivedImage> next(double duration);
  /// Takes what has come on the queue; waits for it where nothing has, but no longer than this (s)
  /// nor than to close().
  void serve(double duration);
  /// Nothing comes any more.
  void close();
  bool isClosed() const { return is_closed_; }

  /// These are safe to call from any thread, also while the input is being closed.
  const std::string& topic() const { return topic_; }
  std::uint32_t publishers() const;
  std::uint64_t received() const { return received_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  void subscribe(const ros::NodeHandle& private_node, const std::string& transport);
  void push(ReceivedImage image);

  const std::size_t queue_size_;
  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  image_transport::ImageTransport image_transport_;
  /// Guards the subscribers, of which one is used.
  mutable std::mutex subscriber_mutex_;
  image_transport::Subscriber subscriber_;
  ros::Subscriber compressed_subscriber_;
  std::string topic_;

  std::deque<ReceivedImage> waiting_;
  std::atomic<std::uint64_t> received_ = 0;
  std::atomic<std::uint64_t> dropped_ = 0;
  std::atomic<bool> is_closed_ = false;
};

}  // namespace omnitag
