#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <string_view>
#include <vector>

#include "common/yaml_reader.h"
#include "omnitag/camera/image_size.h"

/// Cameras of other tools, translated to this package's own camera file. All throw InputError with
/// one line that names file, line and key.
namespace omnitag {

/// A lens as all of these tools describe it; pixels.
struct Intrinsics {
  ImageSize size;
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
  double skew = 0.0;
};

/// `model`, `image` and `lens` of a camera file.
YAML::Node describedCamera(const std::string& model, const Intrinsics& intrinsics);

/// The same with `distortion`.
YAML::Node describedCamera(const std::string& model, const Intrinsics& intrinsics,
                           const std::vector<double>& distortion);

/// OpenCV's coefficients of an ordinary lens, under `key`, as for a pinhole camera: k1, k2, p1, p2
/// and k3. There may be none; any further ones, as in its rational model, must be 0.
std::vector<double> pinholeDistortion(const YamlReader& file, const std::string& key,
                                      std::vector<double> coefficients);

/// The numbers of a matrix: a list of them, or a mapping with such a list in `data`, as in OpenCV's
/// files and camera_info.
std::vector<double> matrixNumbers(const YamlReader& file, const std::string& key);

/// The lens of a camera matrix, a row-by-row list in the same form; focal lengths must be > 0. The
/// size is left out.
Intrinsics cameraMatrix(const YamlReader& file, const std::string& key);

/// A camera of Kalibr's camchain by its name, which may be empty if there is only one.
bool isKalibr(const YamlReader& file);
YAML::Node cameraFromKalibr(const YamlReader& file, const std::string& name);

/// A calibration of OpenCV's modules calib3d, fisheye or omnidir, as its samples store them.
bool isOpenCv(const YamlReader& file);
YAML::Node cameraFromOpenCv(const YamlReader& file);

/// ROS's sensor_msgs/CameraInfo as camera_calibration writes it or as rostopic shows it. If it has
/// binning or a region of interest, the camera is that of the images, not of the sensor.
bool isCameraInfo(const YamlReader& file);
YAML::Node cameraFromCameraInfo(const YamlReader& file);

}  // namespace omnitag
