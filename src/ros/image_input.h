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
#include <vector>

namespace omnitag {

/// Where images come from: a topic and its transport.
struct ImageSource {
  std::string topic = "image";
  std::string transport = "raw";
};

/// An image as it arrived, not decoded yet.
struct ReceivedImage {
  /// Index of its source.
  std::size_t source = 0;
  std_msgs::Header header;
  /// Throws InputError if the message is not an image.
  std::function<cv_bridge::CvImageConstPtr()> decode;
};

/// Subscribes to images and hands them on one by one, to one thread: next comes the source that has
/// waited since the oldest stamp. While images of a source wait, the oldest give way to newer ones
/// and are counted. How many images this process received and dropped is known exactly, unless the
/// thread stays away for more than a second. How many the network or the sender dropped is not:
/// neither stamps nor sequence numbers show it.
///
/// Messages arrive on a separate queue, which that thread serves itself: a nodelet manager would
/// first wake two of its threads for each message.
class ImageInput {
 public:
  /// Subscribes to the sources through image_transport. `compressed` is decoded here, so it needs
  /// no plugin. `queue_size`: for each source. Throws InputError for a transport that cannot be
  /// loaded.
  ImageInput(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
             const std::vector<ImageSource>& sources, int queue_size);
  ~ImageInput() { close(); }
  ImageInput(const ImageInput&) = delete;
  ImageInput& operator=(const ImageInput&) = delete;

  /// The next image, if there is one. If none waits, serves the queue as serve() does.
  std::optional<ReceivedImage> next(double duration);
  /// Takes what has arrived on the queue. If nothing has, waits for at most `duration` (s), or
  /// until close().
  void serve(double duration);
  /// Afterwards, nothing more arrives.
  void close();
  bool isClosed() const { return is_closed_; }

  /// These are safe to call from any thread, even while the input is being closed.
  const std::string& topic(std::size_t source) const { return topics_[source]; }
  std::size_t sources() const { return topics_.size(); }
  std::uint32_t publishers(std::size_t source) const;
  std::uint64_t received(std::size_t source) const { return waiting_[source].received; }
  std::uint64_t received() const;
  std::uint64_t dropped() const { return dropped_; }

 private:
  void subscribe(const ros::NodeHandle& private_node, const ImageSource& source);
  void push(ReceivedImage image);

  const std::size_t queue_size_;
  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  image_transport::ImageTransport image_transport_;
  /// Of a source; only one of the two is used.
  struct Subscription {
    image_transport::Subscriber subscriber;
    ros::Subscriber compressed_subscriber;
  };
  /// Guards the subscriptions.
  mutable std::mutex subscriber_mutex_;
  std::vector<Subscription> subscriptions_;
  std::vector<std::string> topics_;

  /// The waiting images of a source, and the stamp of the first image that came since its last
  /// turn: a source whose images always give way to newer ones still gets its turn.
  struct Waiting {
    std::deque<ReceivedImage> images;
    ros::Time since;
    std::atomic<std::uint64_t> received = 0;
  };
  std::vector<Waiting> waiting_;
  std::atomic<std::uint64_t> dropped_ = 0;
  std::atomic<bool> is_closed_ = false;
};

}  // namespace omnitag
