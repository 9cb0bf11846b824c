#pragma once

#include <cv_bridge/cv_bridge.h>
#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <std_msgs/Header.h>

#include <condition_variable>
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
/// exactly. What the network or the sender dropped is not, since neither stamps nor sequence
/// numbers tell.
class ImageInput {
 public:
  /// Subscribes to `image` by image_transport. `compressed` is decoded here, so that it needs no
  /// plugin. Throws InputError for a transport that cannot be loaded.
  ImageInput(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
             const std::string& transport, int queue_size);
  ~ImageInput() { close(); }
  ImageInput(const ImageInput&) = delete;
  ImageInput& operator=(const ImageInput&) = delete;

  /// Waits for the next image; nothing once the input is closed.
  std::optional<ReceivedImage> next();
  void close();
  bool isClosed() const;

  std::string topic() const;
  std::uint32_t publishers() const;
  std::uint64_t received() const;
  std::uint64_t dropped() const;

 private:
  void push(ReceivedImage image);

  const std::size_t queue_size_;
  image_transport::ImageTransport image_transport_;
  image_transport::Subscriber subscriber_;
  ros::Subscriber compressed_subscriber_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<ReceivedImage> waiting_;
  std::uint64_t received_ = 0;
  std::uint64_t dropped_ = 0;
  bool is_closed_ = false;
};

}  // namespace omnitag
