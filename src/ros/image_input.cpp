#include "omnitag/ros/image_input.h"

#include <image_transport/exception.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <utility>

#include "omnitag/common/error.h"
#include "omnitag/ros/image_conversion.h"

namespace omnitag {
namespace {

/// "compressed" and the transports that have a plugin, without the prefix "image_transport/".
std::string knownTransports(const image_transport::ImageTransport& image_transport) {
  std::string text = "compressed";
  for (const std::string& name : image_transport.getLoadableTransports()) {
    const std::string transport = name.substr(name.rfind('/') + 1);
    if (transport != "compressed") text += ", " + transport;
  }
  return text;
}

ros::NodeHandle withQueue(ros::NodeHandle node, ros::CallbackQueue* queue) {
  node.setCallbackQueue(queue);
  return node;
}

}  // namespace

ImageInput::ImageInput(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                       const std::string& transport, int queue_size)
    : queue_size_(static_cast<std::size_t>(queue_size)),
      node_(withQueue(node, &queue_)),
      image_transport_(node_) {
  subscribe(private_node, transport);
  topic_ = subscriber_ ? subscriber_.getTopic() : compressed_subscriber_.getTopic();
}

void ImageInput::subscribe(const ros::NodeHandle& private_node, const std::string& transport) {
  // Which images wait is decided here, not in ROS's own queue, which drops silently. That one has
  // room for a second's images.
  constexpr std::size_t kMessagesInRosQueue = 30;
  const auto ros_queue_size = static_cast<uint32_t>(queue_size_ + kMessagesInRosQueue);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  if (transport == "compressed") {
    const auto callback = [this](const sensor_msgs::CompressedImageConstPtr& message) {
      push({message->header, [message] { return grayImage(message); }});
    };
    compressed_subscriber_ = node_.subscribe<sensor_msgs::CompressedImage>(
        node_.resolveName("image") + "/compressed", ros_queue_size, callback, nullptr, hints);
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

std::optional<ReceivedImage> ImageInput::next(double duration) {
  serve(waiting_.empty() ? duration : 0.0);
  if (waiting_.empty()) return std::nullopt;
  ReceivedImage image = std::move(waiting_.front());
  waiting_.pop_front();
  return image;
}

void ImageInput::serve(double duration) { queue_.callAvailable(ros::WallDuration(duration)); }

void ImageInput::push(ReceivedImage image) {
  ++received_;
  if (waiting_.size() == queue_size_) {
    waiting_.pop_front();
    ++dropped_;
  }
  waiting_.push_back(std::move(image));
}

void ImageInput::close() {
  is_closed_ = true;
  queue_.disable();
  const std::lock_guard<std::mutex> lock(subscriber_mutex_);
  subscriber_.shutdown();
  compressed_subscriber_.shutdown();
}

std::uint32_t ImageInput::publishers() const {
  const std::lock_guard<std::mutex> lock(subscriber_mutex_);
  return subscriber_ ? subscriber_.getNumPublishers() : compressed_subscriber_.getNumPublishers();
}

}  // namespace omnitag
