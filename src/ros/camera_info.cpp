#include "ros/camera_info.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "camera/camera_yaml.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr const char* kInstead = "; calibrate the camera, or give a camera file";

/// Throws InputError if the message does not describe a camera.
void checkCalibrated(const sensor_msgs::CameraInfo& info, const std::string& topic) {
  const auto isFinite = [](const auto& numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
  };
  constexpr unsigned kMostPixels = 1U << 15U;
  if (info.width < 1 || info.height < 1 || info.width > kMostPixels || info.height > kMostPixels) {
    throw InputError(topic + ": width, height: expected the image's size, found " +
                     std::to_string(info.width) + " x " + std::to_string(info.height));
  }
  if (!isFinite(info.K) || !isFinite(info.D) || !(info.K[0] > 0.0 && info.K[4] > 0.0)) {
    throw InputError(topic + ": K: expected a camera matrix with focal lengths > 0, found none" +
                     kInstead);
  }
}

YAML::Node nodeOf(const sensor_msgs::RegionOfInterest& roi) {
  YAML::Node node(YAML::NodeType::Map);
  node["x_offset"] = roi.x_offset;
  node["y_offset"] = roi.y_offset;
  node["width"] = roi.width;
  node["height"] = roi.height;
  return node;
}

/// The message as a camera file.
YAML::Node nodeOf(const sensor_msgs::CameraInfo& info) {
  YAML::Node node(YAML::NodeType::Map);
  node["width"] = info.width;
  node["height"] = info.height;
  node["distortion_model"] = info.distortion_model;
  node["D"] = info.D;
  node["K"] = std::vector<double>(info.K.begin(), info.K.end());
  node["binning_x"] = info.binning_x;
  node["binning_y"] = info.binning_y;
  node["roi"] = nodeOf(info.roi);
  return node;
}

}  // namespace

DescribedCamera cameraFromFile(const std::string& path) { return {path, loadCamera(path)}; }

DescribedCamera cameraForImages(const DescribedCamera& camera, const ImageSize& size) {
  const std::shared_ptr<const CameraModel> scaled = camera.model->ofImage(size);
  return {camera.origin, scaled ? scaled : camera.model};
}

DescribedCamera cameraFromInfo(const sensor_msgs::CameraInfo& info, const std::string& topic) {
  checkCalibrated(info, topic);
  return {topic, cameraOf(cameraFileOfInfo(nodeOf(info), topic), topic)};
}

}  // namespace omnitag
