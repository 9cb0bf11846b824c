#include "disturbances.h"

#include <yaml-cpp/yaml.h>

#include <cmath>

#include "common/rotation.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

using Normal = std::normal_distribution<double>;

Eigen::Vector3d drawn(double deviation, std::mt19937* generator) {
  Normal normal(0.0, 1.0);
  const double x = normal(*generator);
  const double y = normal(*generator);
  const double z = normal(*generator);
  return deviation * Eigen::Vector3d(x, y, z);
}

void scale(YAML::Node value, double factor) { value = value.as<double>() * factor; }

void move(YAML::Node value, double offset) { value = value.as<double>() + offset; }

/// What a camera file becomes that says to be off by so much in each mode, in pixels of the image.
std::shared_ptr<const CameraModel> cameraStating(double deviation, YAML::Node file,
                                                 const std::string& name) {
  file["uncertainty"] = "none";
  if (deviation > 0.0) {
    YAML::Node uncertainty(YAML::NodeType::Map);
    for (const char* mode : {"principal_point", "scale", "tilt", "rim"}) {
      uncertainty[mode] = deviation;
    }
    file["uncertainty"] = uncertainty;
  }
  YAML::Emitter text;
  text << file;
  return parseCamera(text.c_str(), name);
}

/// Pixels of a camera's image for each where it is 500 pixels high.
double pixelOf(const CameraModel& camera) { return camera.imageSize().height / 500.0; }

std::shared_ptr<const CameraModel> disturbedCamera(const Disturbance& disturbance,
                                                   const CameraModel& exact,
                                                   const std::string& camera_file,
                                                   std::mt19937* generator) {
  Normal normal(0.0, 1.0);
  const double pixel = pixelOf(exact);
  const double rim = exact.rimPixels();
  YAML::Node file = YAML::LoadFile(camera_file);
  YAML::Node lens = file["lens"];
  const double direction = std::uniform_real_distribution<double>(-kPi, kPi)(*generator);
  move(lens["cx"], pixel * (disturbance.center * normal(*generator) +
                            disturbance.fixed_center * std::cos(direction)));
  move(lens["cy"], pixel * (disturbance.center * normal(*generator) +
                            disturbance.fixed_center * std::sin(direction)));
  const double sign = normal(*generator) > 0.0 ? 1.0 : -1.0;
  const double larger =
      1.0 + disturbance.rim * pixel / rim * normal(*generator) + disturbance.focal * sign;
  scale(lens["fx"], larger);
  scale(lens["fy"], larger);
  if (file["mirror"]) move(file["mirror"]["apex_distance"], disturbance.apex * sign);
  return cameraStating(disturbance.stated_camera * pixel, file, camera_file);
}

}  // namespace

std::vector<Disturbance> disturbances() {
  std::vector<Disturbance> rows;
  const auto add = [&rows](const std::string& name) -> Disturbance& {
    rows.emplace_back();
    rows.back().name = name;
    return rows.back();
  };
  add("none");
  Disturbance& leaning = add("lean 0.7 deg, 3 mm, each frame");
  leaning.lean = radians(0.7);
  leaning.height = 0.003;
  for (const double angle : {1.0, 2.0}) {
    Disturbance& constant = add(angle == 1.0 ? "lean 1 deg, 1 cm" : "lean 2 deg, 1 cm");
    constant.constant_lean = radians(angle);
    constant.constant_height = 0.01;
    constant.most_nees = 8.0;
  }
  Disturbance& taped = add("map 5 mm, 1 deg");
  taped.marker = taped.stated_marker = 0.005;
  taped.marker_orientation = taped.stated_marker_orientation = 0.0175;
  Disturbance& rough = add("map 2 cm, 3 deg, said");
  rough.marker = rough.stated_marker = 0.02;
  rough.marker_orientation = rough.stated_marker_orientation = radians(3.0);
  Disturbance& calibrated = add("camera 0.5 px");
  calibrated.center = calibrated.rim = calibrated.stated_camera = 0.5;
  Disturbance& all = add("all of these");
  all = {all.name, leaning.lean, leaning.height,
         0.0,      0.0,          0.005,
         0.0175,   0.005,        0.0175,
         0.5,      0.5,          0.0,
         0.0,      0.0,          0.5,
         0.0};
  const auto addFixed = [&](const std::string& name, double center, double focal, double apex,
                            double most_nees) {
    Disturbance& fixed = add(name);
    fixed.fixed_center = center;
    fixed.focal = focal;
    fixed.apex = apex;
    fixed.stated_camera = 0.5;
    fixed.most_nees = most_nees;
  };
  addFixed("centre 1 px", 1.0, 0.0, 0.0, 8.0);
  addFixed("focal length 1 %", 0.0, 0.01, 0.0, 8.0);
  addFixed("apex 2 mm", 0.0, 0.0, 0.002, 8.0);
  addFixed("centre 1 px, 1 %, 2 mm", 1.0, 0.01, 0.002, 8.0);
  addFixed("centre 3 px, 3 %", 3.0, 0.03, 0.0, 30.0);
  return rows;
}

std::shared_ptr<const CameraModel> trueCamera(const Disturbance& disturbance,
                                              const CameraModel& exact,
                                              const std::string& camera_file) {
  return cameraStating(disturbance.stated_camera * pixelOf(exact), YAML::LoadFile(camera_file),
                       camera_file);
}

DisturbedFrame disturbed(const Disturbance& disturbance, const RecordedSequence& sequence,
                         const std::string& camera_file, std::size_t frame,
                         std::mt19937* generator) {
  DisturbedFrame result;
  result.camera = disturbedCamera(disturbance, *sequence.camera, camera_file, generator);
  result.map = sequence.map;
  for (Marker& marker : result.map.markers) {
    marker.map_from_marker.translation() += drawn(disturbance.marker, generator);
    marker.map_from_marker.linear() = rotationOf(drawn(disturbance.marker_orientation, generator)) *
                                      marker.map_from_marker.linear();
    marker.deviation = disturbance.stated_marker;
    marker.orientation_deviation = disturbance.stated_marker_orientation;
  }
  // The base that leans is one that the camera is mounted on otherwise than tf says.
  Normal normal(0.0, 1.0);
  const double direction = std::uniform_real_distribution<double>(-kPi, kPi)(*generator);
  const Pose lean{
      0.0,
      0.0,
      0.0,
      disturbance.height * normal(*generator) + disturbance.constant_height,
      disturbance.lean * normal(*generator) + disturbance.constant_lean * std::cos(direction),
      disturbance.lean * normal(*generator) + disturbance.constant_lean * std::sin(direction)};
  result.frame = sequence.frames[frame];
  result.frame.base_from_camera = lean.toIsometry().inverse() * result.frame.base_from_camera;
  result.truth = sequence.truth[frame] * lean;
  return result;
}

}  // namespace omnitag
