#include "ros/image_input.h"

#include <image_transport/exception.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <algorithm>
#include <boost/function.hpp>
#include <numeric>
#include <utility>

#include "omnitag/common/error.h"
#include "ros/image_conversion.h"

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
                       const std::vector<ImageSource>& sources, int queue_size)
    : queue_size_(static_cast<std::size_t>(queue_size)),
      node_(withQueue(node, &queue_)),
      image_transport_(node_),
      waiting_(sources.size()) {
  for (const ImageSource& source : sources) subscribe(private_node, source);
}

void ImageInput::subscribe(const ros::NodeHandle& private_node, const ImageSource& source) {
  // Which images wait is decided here, because ROS's own queue drops silently; it has room for a
  // second's images.
  constexpr std::size_t kMessagesInRosQueue = 30;
  const auto ros_queue_size = static_cast<uint32_t>(queue_size_ + kMessagesInRosQueue);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  const std::size_t index = subscriptions_.size();
  Subscription& subscription = subscriptions_.emplace_back();
  const auto take = [this, index](const auto& message) {
    push({index, message->header, [message] { return grayImage(message); }});
  };
  if (source.transport == "compressed") {
    subscription.compressed_subscriber = node_.subscribe<sensor_msgs::CompressedImage>(
        node_.resolveName(source.topic) + "/compressed", ros_queue_size,
        boost::function<void(const sensor_msgs::CompressedImageConstPtr&)>(take), nullptr, hints);
    topics_.push_back(subscription.compressed_subscriber.getTopic());
    return;
  }
  try {
    subscription.subscriber = image_transport_.subscribe(
        source.topic, ros_queue_size,
        boost::function<void(const sensor_msgs::ImageConstPtr&)>(take), nullptr,
        image_transport::TransportHints(source.transport, hints, private_node));
    topics_.push_back(subscription.subscriber.getTopic());
  } catch (const image_transport::Exception&) {
    throw InputError(private_node.getNamespace() + ": image_transport: expected one of " +
                     knownTransports(image_transport_) + ", found '" + source.transport + "'");
  }
}

std::optional<ReceivedImage> ImageInput::next(double duration) {
  const auto longest = [this] {
    return std::min_element(waiting_.begin(), waiting_.end(),
                            [](const Waiting& a, const Waiting& b) {
                              if (a.images.empty() || b.images.empty()) return !a.images.empty();
                              return a.since < b.since;
                            });
  };
  serve(longest()->images.empty() ? duration : 0.0);
  const auto next = longest();
  if (next->images.empty()) return std::nullopt;
  ReceivedImage image = std::move(next->images.front());
  next->images.pop_front();
  if (!next->images.empty()) next->since = next->images.front().header.stamp;
  return image;
}

void ImageInput::serve(double duration) { queue_.callAvailable(ros::WallDuration(duration)); }

void ImageInput::push(ReceivedImage image) {
  Waiting& waiting = waiting_[image.source];
  ++waiting.received;
  if (waiting.images.empty()) waiting.since = image.header.stamp;
  if (waiting.images.size() == queue_size_) {
    waiting.images.pop_front();
    ++dropped_;
  }
  waiting.images.push_back(std::move(image));
}

void ImageInput::close() {
  is_closed_ = true;
  queue_.disable();
  const std::lock_guard<std::mutex> lock(subscriber_mutex_);
  for (Subscription& subscription : subscriptions_) {
    subscription.subscriber.shutdown();
    subscription.compressed_subscriber.shutdown();
  }
}

std::uint32_t ImageInput::publishers(std::size_t source) const {
  const std::lock_guard<std::mutex> lock(subscriber_mutex_);
  const Subscription& subscription = subscriptions_[source];
  return subscription.subscriber ? subscription.subscriber.getNumPublishers()
                                 : subscription.compressed_subscriber.getNumPublishers();
}

std::uint64_t ImageInput::received() const {
  return std::accumulate(
      waiting_.begin(), waiting_.end(), std::uint64_t{0},
      [](std::uint64_t sum, const Waiting& waiting) { return sum + waiting.received; });
}

}  // namespace omnitag
