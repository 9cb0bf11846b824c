#include "omnitag/ros/camera_info.h"

#include <algorithm>
#include <cmath>

#include "omnitag/camera/camera_file.h"
#include "omnitag/camera/equidistant_camera.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr const char* kInstead = "; calibrate the camera, or give a camera file";

/// Throws unless the message says something about a camera at all.
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

/// Throws where pixels of the images are not those of the calibration.
void checkWhole(const sensor_msgs::CameraInfo& info, const std::string& topic) {
  const auto& roi = info.roi;
  const bool is_whole = roi.x_offset == 0 && roi.y_offset == 0 &&
                        (roi.width == 0 || roi.width == info.width) &&
                        (roi.height == 0 || roi.height == info.height);
  if (!is_whole) throw InputError(topic + ": roi: expected whole images, found a part of them");
  if (info.binning_x > 1 || info.binning_y > 1) {
    throw InputError(topic + ": binning: expected none, found " + std::to_string(info.binning_x) +
                     " x " + std::to_string(info.binning_y));
  }
}

}  // namespace

DescribedCamera cameraFromFile(const std::string& path) { return {path, loadCamera(path)}; }

DescribedCamera cameraFromInfo(const sensor_msgs::CameraInfo& info, const std::string& topic) {
  checkCalibrated(info, topic);
  checkWhole(info, topic);
  EquidistantCamera::Coefficients coefficients{};
  if (info.distortion_model != "equidistant") {
    throw InputError(topic + ": distortion_model: expected 'equidistant', found '" +
                     info.distortion_model + "'" + kInstead);
  }
  if (info.D.size() != coefficients.size()) {
    throw InputError(topic + ": D: expected 4 numbers, found " + std::to_string(info.D.size()) +
                     kInstead);
  }
  std::copy(info.D.begin(), info.D.end(), coefficients.begin());
  const ImageSize image_size{static_cast<int>(info.width), static_cast<int>(info.height)};
  Eigen::Matrix2d affine;
  affine << info.K[0], info.K[1], info.K[3], info.K[4];
  const ImagePlane image_plane(affine, {info.K[2], info.K[5]});
  try {
    return {topic, std::make_shared<EquidistantCamera>(image_size, image_plane, coefficients)};
  } catch (const InputError& error) {
    throw InputError(topic + ": " + error.what());
  }
}

}  // namespace omnitag
