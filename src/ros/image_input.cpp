#include "omnitag/ros/image_input.h"

#include <image_transport/exception.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <utility>

#include "omnitag/common/error.h"
#include "omnitag/ros/image_conversion.h"

namespace omnitag {
namespace {

/// "compressed" and the transports that have a plugin, whose names begin with "image_transport/".
std::string knownTransports(const image_transport::ImageTransport& image_transport) {
  std::string text = "compressed";
  for (const std::string& name : image_transport.getLoadableTransports()) {
    const std::string transport = name.substr(name.rfind('/') + 1);
    if (transport != "compressed") text += ", " + transport;
  }
  return text;
}

}  // namespace

ImageInput::ImageInput(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                       const std::string& transport, int queue_size)
    : queue_size_(static_cast<std::size_t>(queue_size)), image_transport_(node) {
  // What waits is decided here, not in ROS's own queue, which drops without a word.
  constexpr int kMessagesInRosQueue = 10;
  const auto ros_queue_size = static_cast<uint32_t>(queue_size + kMessagesInRosQueue);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  if (transport == "compressed") {
    ros::NodeHandle subscribing_node(node);
    const auto callback = [this](const sensor_msgs::CompressedImageConstPtr& message) {
      push({message->header, [message] { return grayImage(message); }});
    };
    compressed_subscriber_ = subscribing_node.subscribe<sensor_msgs::CompressedImage>(
        node.resolveName("image") + "/compressed", ros_queue_size, callback, nullptr, hints);
    return;
  }
  try {
    const auto callback = [this](const sensor_msgs::ImageConstPtr& message) {
      push({message->header, [message] { return grayImage(message); }});
    };
    subscriber_ =
        image_transport_.subscribe("image", ros_queue_size, callback, nullptr,
                                   image_transport::TransportHints(transport, hints, private_node));
  } catch (const image_transport::Exception&) {
    throw InputError(private_node.getNamespace() + ": image_transport: expected one of " +
                     knownTransports(image_transport_) + ", found '" + transport + "'");
  }
}

std::optional<ReceivedImage> ImageInput::next() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return is_closed_ || !waiting_.empty(); });
  if (is_closed_) return std::nullopt;
  ReceivedImage image = std::move(waiting_.front());
  waiting_.pop_front();
  return image;
}

void ImageInput::push(ReceivedImage image) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++received_;
  if (waiting_.size() == queue_size_) {
    waiting_.pop_front();
    ++dropped_;
  }
  waiting_.push_back(std::move(image));
  changed_.notify_one();
}

void ImageInput::close() {
  subscriber_.shutdown();
  compressed_subscriber_.shutdown();
  const std::lock_guard<std::mutex> lock(mutex_);
  is_closed_ = true;
  waiting_.clear();
  changed_.notify_all();
}

bool ImageInput::isClosed() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return is_closed_;
}

std::string ImageInput::topic() const {
  return subscriber_ ? subscriber_.getTopic() : compressed_subscriber_.getTopic();
}

std::uint32_t ImageInput::publishers() const {
  return subscriber_ ? subscriber_.getNumPublishers() : compressed_subscriber_.getNumPublishers();
}

std::uint64_t ImageInput::received() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return received_;
}

std::uint64_t ImageInput::dropped() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return dropped_;
}

}  // namespace omnitag
