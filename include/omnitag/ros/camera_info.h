#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <memory>
#include <string>

#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// A camera, and what described it: a file or a topic.
struct DescribedCamera {
  std::string origin;
  std::shared_ptr<const CameraModel> model;
};

/// The camera file's camera. Throws InputError.
DescribedCamera cameraFromFile(const std::string& path);

/// The fisheye that a driver describes beside its images, with the distortion model "equidistant".
/// `topic` is where the message came from. Throws InputError where the camera is not calibrated,
/// its distortion another one, or the images only a part of its sensor.
DescribedCamera cameraFromInfo(const sensor_msgs::CameraInfo& info, const std::string& topic);

}  // namespace omnitag
