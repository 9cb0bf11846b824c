#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <memory>
#include <string>

#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// A camera and its source: a file or a topic.
struct DescribedCamera {
  std::string origin;
  std::shared_ptr<const CameraModel> model;
};

/// The camera that a file describes. Throws InputError.
DescribedCamera cameraFromFile(const std::string& path);

/// The camera, scaled to images of this size if its file says `scale_to_image`. If that is
/// impossible, it stays as it is, and FrameAssembler refuses the images.
DescribedCamera cameraForImages(const DescribedCamera& camera, const ImageSize& size);

/// The camera that a driver describes beside its images: a fisheye with the distortion model
/// "equidistant" or "fisheye", an ordinary lens with "plumb_bob". If the images are binned or show
/// a part of the sensor, it is the camera of these images. `topic`: where the message came from.
/// Throws InputError if the camera is not calibrated or has another distortion model.
DescribedCamera cameraFromInfo(const sensor_msgs::CameraInfo& info, const std::string& topic);

}  // namespace omnitag
