#include "recorded_sequence.h"

#include <cv_bridge/cv_bridge.h>
#include <geometry_msgs/PoseStamped.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <map>
#include <memory>

#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"
#include "ros/conversions.h"
#include "ros/frame_assembler.h"
#include "ros/image_conversion.h"
#include "ros/parameters.h"

namespace omnitag {
namespace {

/// Nothing where the message is no image.
cv_bridge::CvImageConstPtr grayImageOf(const rosbag::MessageInstance& message) {
  if (const auto raw = message.instantiate<sensor_msgs::Image>()) return grayImage(raw);
  if (const auto compressed = message.instantiate<sensor_msgs::CompressedImage>()) {
    return grayImage(compressed);
  }
  return nullptr;
}

/// All of the bag's transforms, none forgotten.
std::unique_ptr<tf2::BufferCore> transformsOf(const rosbag::Bag& bag) {
  constexpr double kADay = 86400.0;
  auto transforms = std::make_unique<tf2::BufferCore>(ros::Duration(kADay));
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    const auto some = message.instantiate<tf2_msgs::TFMessage>();
    if (!some) continue;
    const bool is_static = message.getTopic() == "/tf_static";
    for (const auto& one : some->transforms) transforms->setTransform(one, "bag", is_static);
  }
  return transforms;
}

/// base_link in the map, by the stamps of the images.
std::map<ros::Time, Pose> truthOf(const rosbag::Bag& bag) {
  std::map<ros::Time, Pose> truth;
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    const auto pose = message.instantiate<geometry_msgs::PoseStamped>();
    if (pose) truth[pose->header.stamp] = Pose::fromIsometry(fromMessage(pose->pose));
  }
  return truth;
}

}  // namespace

RecordedSequence loadSequence(const std::string& bag, const std::string& camera_file,
                              const std::string& map_file, const std::string& odom_frame) {
  RecordedSequence sequence;
  sequence.camera = loadCamera(camera_file);
  sequence.map = loadMarkerMap(map_file);

  const rosbag::Bag opened(bag);
  const auto transforms = transformsOf(opened);
  const std::map<ros::Time, Pose> truth = truthOf(opened);
  FrameNames names;
  names.odom = odom_frame;
  const FrameAssembler assembler(camera_file, sequence.camera->imageSize(), names);
  for (const rosbag::MessageInstance& message : rosbag::View(opened)) {
    const cv_bridge::CvImageConstPtr image = grayImageOf(message);
    if (!image) continue;
    const auto pose = truth.find(image->header.stamp);
    if (pose == truth.end()) throw InputError(bag + ": an image without its true pose");
    Frame frame = assembler.assemble(image, *transforms).frame;
    // The message that holds its pixels ends here.
    frame.image = frame.image.clone();
    sequence.frames.push_back(frame);
    sequence.truth.push_back(pose->second);
  }
  if (sequence.frames.empty()) throw InputError(bag + ": has no images");
  return sequence;
}

RecordedSequence shippedSequence() {
  const std::string package = PACKAGE_DIR;
  return loadSequence(package + "/bags/paper.bag", package + "/config/cameras/paper.yaml",
                      package + "/maps/paper.yaml");
}

std::string cameraFileFrom(int argc, char** argv) {
  constexpr int kCamera = 2;
  return argc > kCamera ? argv[kCamera] : std::string(PACKAGE_DIR) + "/config/cameras/paper.yaml";
}

RecordedSequence sequenceFrom(int argc, char** argv, const std::string& odom_frame) {
  if (argc == 1) return shippedSequence();
  if (argc != 4) throw InputError("expected BAG CAMERA MAP, or nothing");
  return loadSequence(argv[1], argv[2], argv[3], odom_frame);
}

}  // namespace omnitag
