#include "ros/bag_tools/bag_input.h"

#include <image_transport/camera_common.h>
#include <rosbag/exceptions.h>
#include <rosbag/view.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Header.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <fstream>
#include <map>
#include <set>
#include <vector>

#include "omnitag/common/error.h"
#include "ros/conversions.h"
#include "ros/image_conversion.h"

namespace omnitag {
namespace {

const std::string kCompressed = "/compressed";
const std::string kCompressedDepth = "/compressedDepth";

bool endsWith(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

void open(const std::string& path, rosbag::Bag* bag) {
  if (!std::ifstream(path)) throw InputError(path + ": expected a readable file, found none");
  try {
    bag->open(path, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw InputError(path +
                     ": is not indexed, as a recording that was cut off; rosbag reindex "
                     "repairs it");
  } catch (const std::exception& error) {
    throw InputError(path + ": expected a bag: " + error.what());
  }
}

using Bags = std::vector<std::unique_ptr<rosbag::Bag>>;

/// Adds the bags' messages to a view, in the order of recording.
template <typename... Query>
void addTo(rosbag::View* view, const Bags& bags, const Query&... query) {
  for (const auto& bag : bags) view->addQuery(*bag, query...);
}

/// The bags' topics and their types.
std::map<std::string, std::string> topicsOf(const Bags& bags) {
  rosbag::View view;
  addTo(&view, bags);
  std::map<std::string, std::string> topics;
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    topics[connection->topic] = connection->datatype;
  }
  return topics;
}

/// Whether the localizer painted the images.
bool isDebugImage(const std::string& topic) {
  return endsWith(topic, "/debug_image") || endsWith(topic, "/debug_image" + kCompressed);
}

std::vector<std::string> imageTopicsOf(const std::map<std::string, std::string>& topics) {
  std::vector<std::string> names;
  for (const auto& [topic, type] : topics) {
    const bool is_raw = type == "sensor_msgs/Image";
    const bool is_compressed =
        type == "sensor_msgs/CompressedImage" && !endsWith(topic, kCompressedDepth);
    if ((is_raw || is_compressed) && !isDebugImage(topic)) names.push_back(topic);
  }
  return names;
}

std::string chooseImageTopic(const std::string& path, const Bags& bags, const std::string& wanted) {
  const std::map<std::string, std::string> topics = topicsOf(bags);
  const std::vector<std::string> candidates = imageTopicsOf(topics);
  if (candidates.empty()) {
    throw InputError(path + ": has no images (sensor_msgs/Image or CompressedImage)");
  }
  if (wanted.empty()) {
    // The same images may exist both raw and compressed.
    const bool is_one = candidates.size() == 1 ||
                        (candidates.size() == 2 && candidates[1] == candidates[0] + kCompressed);
    if (is_one) return candidates.front();
    throw InputError(path + ": has several image topics, choose one with --image-topic: " +
                     boost::algorithm::join(candidates, ", "));
  }
  for (const std::string& name : {wanted, wanted + kCompressed}) {
    const auto found =
        std::find_if(candidates.begin(), candidates.end(), [&name](const std::string& candidate) {
          return withoutSlash(candidate) == withoutSlash(name);
        });
    if (found != candidates.end()) return *found;
  }
  throw InputError(path + ": --image-topic: expected one of " +
                   boost::algorithm::join(candidates, ", ") + ", found '" + wanted + "'");
}

/// The header of an image message.
std_msgs::Header headerOf(const rosbag::MessageInstance& message) {
  if (const auto raw = message.instantiate<sensor_msgs::Image>()) return raw->header;
  if (const auto compressed = message.instantiate<sensor_msgs::CompressedImage>()) {
    return compressed->header;
  }
  return {};
}

}  // namespace

BagInput::BagInput(const std::vector<std::string>& paths,
                   const std::vector<std::string>& image_topics, const RecordedSpan& span)
    : path_(boost::algorithm::join(paths, ", ")) {
  for (const std::string& path : paths) {
    open(path, bags_.emplace_back(std::make_unique<rosbag::Bag>()).get());
  }
  for (const std::string& topic : image_topics) {
    image_topics_.push_back(chooseImageTopic(path_, bags_, topic));
  }
  try {
    setSpan(span);
    loadTransforms("");
  } catch (const rosbag::BagException& error) {
    throw InputError(path_ + ": " + error.what());
  }
}

void BagInput::setSpan(const RecordedSpan& span) {
  rosbag::View view;
  addTo(&view, bags_);
  const ros::Time first = view.getBeginTime();
  const double duration = (view.getEndTime() - first).toSec();
  if (span.from > 0.0) begin_ = first + ros::Duration(std::min(span.from, duration + 1.0));
  if (span.until < duration) end_ = first + ros::Duration(span.until);
}

bool BagInput::isImage(const rosbag::MessageInstance& message) const {
  return std::find(image_topics_.begin(), image_topics_.end(), message.getTopic()) !=
         image_topics_.end();
}

std::size_t BagInput::imageCount() const {
  rosbag::View view;
  addTo(&view, bags_, rosbag::TopicQuery(image_topics_), begin_, end_);
  return view.size();
}

template <typename... Query>
void BagInput::forEach(const MessageUser& use, const Query&... query) const {
  const bool is_merged =
      std::set<std::string>(image_topics_.begin(), image_topics_.end()).size() > 1;
  if (is_merged) {
    rosbag::View view;
    addTo(&view, bags_, query...);
    for (const rosbag::MessageInstance& message : view) use(message);
    return;
  }
  for (const auto& bag : bags_) {
    for (const rosbag::MessageInstance& message : rosbag::View(*bag, query...)) use(message);
  }
}

void BagInput::forEachImage(const MessageUser& use) const {
  forEach(use, rosbag::TopicQuery(image_topics_), begin_, end_);
}

void BagInput::forEachMessage(const MessageUser& use) const { forEach(use, begin_, end_); }

void BagInput::forEachEarlierStatic(const MessageUser& use) const {
  if (begin_ == ros::TIME_MIN) return;
  rosbag::View view;
  addTo(&view, bags_, rosbag::TopicQuery("/tf_static"), ros::TIME_MIN,
        begin_ - ros::Duration(0, 1));
  for (const rosbag::MessageInstance& message : view) use(message);
}

void BagInput::forEachTransform(
    const std::function<void(const geometry_msgs::TransformStamped&, bool)>& take) const {
  const std::vector<std::string> topics = {"/tf", "/tf_static", "tf", "tf_static"};
  rosbag::View view;
  addTo(&view, bags_, rosbag::TopicQuery(topics));
  for (const rosbag::MessageInstance& message : view) {
    const tf2_msgs::TFMessageConstPtr transforms = message.instantiate<tf2_msgs::TFMessage>();
    if (!transforms) continue;
    for (const geometry_msgs::TransformStamped& transform : transforms->transforms) {
      take(transform, endsWith(message.getTopic(), "tf_static"));
    }
  }
}

void BagInput::loadTransforms(const std::string& without_child) {
  // Nothing is forgotten, however far apart the stamps are.
  constexpr double kAYear = 365.0 * 86400.0;
  transforms_ = std::make_unique<tf2::BufferCore>(ros::Duration(kAYear));
  forEachTransform([&](const geometry_msgs::TransformStamped& transform, bool is_static) {
    if (withoutSlash(transform.child_frame_id) == without_child) return;
    transforms_->setTransform(transform, "bag", is_static);
  });
}

std::optional<std::string> BagInput::parentConflict(const FrameNames& frames) const {
  // All of the bag's transforms count, however far apart in time they are.
  constexpr double kNow = 0.0;
  ParentWatch parents(frames);
  forEachTransform([&](const geometry_msgs::TransformStamped& transform, bool is_static) {
    parents.see(transform, is_static, kNow);
  });
  return parents.conflict(kNow);
}

void BagInput::replaceMounting(const std::string& base_frame,
                               const Eigen::Isometry3d& base_from_camera) {
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = base_frame;
  transform.child_frame_id = cameraFrame();
  transform.transform = toMessage(base_from_camera);
  // Without the frame's own transforms: tf2 would continue to use those of /tf.
  loadTransforms(withoutSlash(transform.child_frame_id));
  if (!transforms_->setTransform(transform, "option", true)) {
    throw InputError(path_ + ": cannot replace the mounting of '" + transform.child_frame_id +
                     "' on '" + base_frame + "'");
  }
}

// From the headers alone: an image that cannot be decoded is reported when it is its turn.
std::string BagInput::cameraFrame() const {
  rosbag::View view;
  addTo(&view, bags_, rosbag::TopicQuery(imageTopic()));
  for (const rosbag::MessageInstance& message : view) {
    const std_msgs::Header header = headerOf(message);
    if (!header.frame_id.empty()) return header.frame_id;
  }
  throw InputError(path_ + ": " + imageTopic() +
                   ": expected images with a header.frame_id, found none");
}

DescribedCamera BagInput::describedCamera(std::size_t camera) const {
  std::string image_topic = imageTopic(camera);
  if (endsWith(image_topic, kCompressed)) {
    image_topic.resize(image_topic.size() - kCompressed.size());
  }
  const std::string topic = image_transport::getCameraInfoTopic(image_topic);
  rosbag::View view;
  addTo(&view, bags_, rosbag::TopicQuery(topic));
  for (const rosbag::MessageInstance& message : view) {
    const auto info = message.instantiate<sensor_msgs::CameraInfo>();
    if (info) return cameraFromInfo(*info, path_ + ": " + topic);
  }
  throw InputError(path_ + ": expected camera_info on " + topic +
                   " as there is no --camera, found none");
}

DescribedCamera BagInput::cameraOf(const std::string& file, std::size_t camera) const {
  if (file.empty()) return describedCamera(camera);
  const DescribedCamera described = cameraFromFile(file);
  const std::optional<ImageSize> size =
      described.model->scalesToImage() ? imageSize(camera) : std::nullopt;
  return size ? cameraForImages(described, *size) : described;
}

std::optional<ImageSize> BagInput::imageSize(std::size_t camera) const {
  rosbag::View view;
  addTo(&view, bags_, rosbag::TopicQuery(imageTopic(camera)));
  if (view.begin() == view.end()) return std::nullopt;
  try {
    const cv_bridge::CvImageConstPtr image = grayImageOf(*view.begin());
    return ImageSize{image->image.cols, image->image.rows};
  } catch (const InputError&) {
    return std::nullopt;
  }
}

cv_bridge::CvImageConstPtr BagInput::grayImageOf(const rosbag::MessageInstance& message) {
  if (const auto raw = message.instantiate<sensor_msgs::Image>()) return grayImage(raw);
  if (const auto compressed = message.instantiate<sensor_msgs::CompressedImage>()) {
    return grayImage(compressed);
  }
  throw InputError(message.getTopic() + ": expected an image, found " + message.getDataType());
}

}  // namespace omnitag
