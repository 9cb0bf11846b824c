#include "recorded_sequence.h"

#include <geometry_msgs/PoseStamped.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <tf2_msgs/TFMessage.h>

#include <map>
#include <optional>

#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"
#include "omnitag/ros/conversions.h"
#include "omnitag/ros/image_conversion.h"

namespace omnitag {
namespace {

cv::Mat grayImageOf(const rosbag::MessageInstance& message) {
  if (const auto raw = message.instantiate<sensor_msgs::Image>()) return grayImage(raw)->image;
  if (const auto compressed = message.instantiate<sensor_msgs::CompressedImage>()) {
    return grayImage(compressed)->image;
  }
  return {};
}

ros::Time stampOf(const rosbag::MessageInstance& message) {
  if (const auto raw = message.instantiate<sensor_msgs::Image>()) return raw->header.stamp;
  return message.instantiate<sensor_msgs::CompressedImage>()->header.stamp;
}

}  // namespace

RecordedSequence loadSequence(const std::string& bag, const std::string& camera_file,
                              const std::string& map_file) {
  RecordedSequence sequence;
  sequence.camera = loadCamera(camera_file);
  sequence.map = loadMarkerMap(map_file);

  const rosbag::Bag opened(bag);
  std::optional<Eigen::Isometry3d> base_from_camera;
  std::map<ros::Time, Pose> truth;
  for (const rosbag::MessageInstance& message : rosbag::View(opened)) {
    if (const auto pose = message.instantiate<geometry_msgs::PoseStamped>()) {
      truth[pose->header.stamp] = Pose::fromIsometry(fromMessage(pose->pose));
    } else if (message.getTopic() == "/tf_static") {
      base_from_camera =
          fromMessage(message.instantiate<tf2_msgs::TFMessage>()->transforms.at(0).transform);
    }
  }
  if (!base_from_camera) throw InputError(bag + ": /tf_static: expected the camera's mounting");
  for (const rosbag::MessageInstance& message : rosbag::View(opened)) {
    const cv::Mat image = grayImageOf(message);
    if (image.empty()) continue;
    const ros::Time stamp = stampOf(message);
    if (truth.count(stamp) == 0) throw InputError(bag + ": an image without its true pose");
    sequence.frames.push_back({stamp.toSec(), image, *base_from_camera, std::nullopt});
    sequence.truth.push_back(truth[stamp]);
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

RecordedSequence sequenceFrom(int argc, char** argv) {
  if (argc == 1) return shippedSequence();
  if (argc != 4) throw InputError("expected BAG CAMERA MAP, or nothing");
  return loadSequence(argv[1], argv[2], argv[3]);
}

}  // namespace omnitag
