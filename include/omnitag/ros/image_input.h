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

/// An image as it arrived, not decoded yet.
struct ReceivedImage {
  std_msgs::Header header;
  /// Throws InputError if the message is not an image.
  std::function<cv_bridge::CvImageConstPtr()> decode;
};

/// Subscribes to images and hands them on one by one, to one thread. While images wait, the oldest
/// give way to newer ones and are counted. How many images this process received and dropped is
/// known exactly, unless the thread stays away for more than a second. How many the network or the
/// sender dropped is not, since neither stamps nor sequence numbers show it.
///
/// Messages arrive on a queue of its own, which that thread serves itself: a nodelet manager would
/// wake two of its threads for each message first.
class ImageInput {
 public:
  /// Subscribes to `image` through image_transport. `compressed` is decoded here, so that it needs
  /// no plugin. Throws InputError for a transport that cannot be loaded.
  ImageInput(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
             const std::string& transport, int queue_size);
  ~ImageInput() { close(); }
  ImageInput(const ImageInput&) = delete;
  ImageInput& operator=(const ImageInput&) = delete;

  /// The next image, if there is one. If none waits, serves the queue as serve() does.
  std::optional<ReceivedImage> next(double duration);
  /// Takes what has arrived on the queue. If nothing has, waits for at most `duration` (s), or
  /// until close().
  void serve(double duration);
  /// Nothing arrives afterwards.
  void close();
  bool isClosed() const { return is_closed_; }

  /// The following are safe to call from any thread, also while the input is being closed.
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
  /// Guards the subscribers, only one of which is used.
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
