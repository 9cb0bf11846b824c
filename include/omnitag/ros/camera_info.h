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

/// The same camera, or where its file says `scale_to_image` the one of images of this size. A
/// camera that cannot have such images stays as it is: whoever gets one says what is wrong.
DescribedCamera cameraForImages(const DescribedCamera& camera, const ImageSize& size);

/// The camera that a driver describes beside its images: a fisheye by the distortion models
/// "equidistant" or "fisheye", an ordinary lens by "plumb_bob". Where the images are binned, or a
/// part of the sensor, it is the camera of these. `topic` is where the message came from. Throws
/// InputError where the camera is not calibrated, or its distortion another one.
DescribedCamera cameraFromInfo(const sensor_msgs::CameraInfo& info, const std::string& topic);

}  // namespace omnitag
