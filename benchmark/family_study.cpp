// How small a marker of each family may be in the image: the width of a module, in pixels along the
// marker's longest edge, at which nine of ten markers are
//
//   recognized   where they are predicted, 5 mm and 0.1 degrees off (standard deviations), as after
//                the first markers of an image
//   read         in a search, without a prediction
//
// on average over the incidences and a draw of places around the robot, in the worse of two
// cameras: the mirror of the paper's experiment and a fisheye of 500 x 500. Images have noise of 3
// grey levels and no blur; a marker is 2.5 m away, on a wall. The last lines are the table of
// src/planning/family_limits.cpp.
//
//   family_study [DRAWS]     for each size and incidence; 6 by default

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "omnitag/camera/camera_file.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/marker/marker_prediction.h"
#include "omnitag/photometry/recognition.h"
#include "prediction.h"
#include "program.h"
#include "room_renderer.h"

namespace omnitag {
namespace {

constexpr std::array<const char*, 11> kFamilies{
    "tag36h11",           "tag25h9",     "tag16h5",      "tagStandard41h12", "tagStandard52h13",
    "tagCircle21h7",      "DICT_4X4_50", "DICT_5X5_100", "DICT_6X6_250",     "DICT_7X7_250",
    "DICT_ARUCO_ORIGINAL"};
constexpr std::array<double, 13> kModules{0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.4,
                                          1.6, 1.8, 2.0, 2.4, 2.8, 3.4};
constexpr std::array<double, 3> kIncidences{0.0, 30.0, 50.0};  // degrees

/// A camera on a robot at the origin.
struct Eye {
  const char* name;
  MountedCamera camera;
  RoomRenderer renderer;
};

Eye eyeOf(const char* name, const std::string& file, const Eigen::Isometry3d& mounting) {
  const MountedCamera camera(loadCamera(std::string(PACKAGE_DIR) + "/config/cameras/" + file),
                             mounting);
  return {name, camera, RoomRenderer(camera)};
}

std::vector<Eye> eyes() {
  std::vector<Eye> eyes;
  eyes.push_back(eyeOf(
      "mirror", "paper.yaml",
      Eigen::Translation3d(0.1, 0.0, 1.1) * Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX())));
  eyes.push_back(
      eyeOf("fisheye", "fisheye.yaml", Eigen::Isometry3d(Eigen::Translation3d(0.1, 0.0, 0.5))));
  return eyes;
}

/// A marker whose modules are so wide in the image, and the wall behind it.
struct Scene {
  MarkerMap map;
  std::vector<Wall> walls;
};

Scene sceneOf(const Eye& eye, const std::string& family, double module, double incidence,
              std::mt19937* generator) {
  constexpr double kDistance = 2.5;  // m
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double direction = 2.0 * kPi * uniform(*generator);
  const double side = uniform(*generator) < 0.5 ? -1.0 : 1.0;
  Marker marker;
  marker.family = family;
  marker.id = static_cast<int>(20.0 * uniform(*generator));
  const Eigen::Vector2d place(kDistance * std::cos(direction), kDistance * std::sin(direction));
  const double yaw = direction + kPi + side * radians(incidence);
  marker.map_from_marker =
      Eigen::Translation3d(place.x(), place.y(), 1.0 + 0.6 * uniform(*generator)) *
      uprightOrientation(yaw, 0.0);
  const int modules = TagPattern(family, marker.id).widthBetweenCorners();
  VisibilityConfig any;
  any.min_edge_pixels = 0.0;
  Scene scene;
  scene.map.markers = {marker};
  Marker& sized = scene.map.markers.front();
  sized.size = 0.1;
  for (int round = 0; round < 3; ++round) {
    const auto predicted = predictMarker(scene.map, 0, eye.camera, {}, any);
    if (!predicted) throw InputError("the camera does not see the marker");
    sized.size *= module * modules / longestEdge(predicted->corners);
  }
  constexpr double kHalf = 4.0;     // m
  constexpr double kBehind = 0.01;  // m
  const Eigen::Vector2d along(-std::sin(yaw), std::cos(yaw));
  const Eigen::Vector2d behind = place - kBehind * Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
  scene.walls = {{behind - kHalf * along, behind + kHalf * along}};
  return scene;
}

bool isRecognized(const Eye& eye, const Scene& scene, const cv::Mat& image,
                  std::mt19937* generator) {
  const PoseEstimate predicted_pose = drawnPrediction({}, 0.005, radians(0.1), generator);
  VisibilityConfig any;
  any.min_edge_pixels = 0.0;
  const auto predicted = predictMarker(scene.map, 0, eye.camera, predicted_pose, any);
  if (!predicted) return false;
  const Marker& marker = scene.map.markers.front();
  const auto recognition = recognize(image, marker, TagPattern(marker.family, marker.id),
                                     eye.camera, predicted_pose.pose, *predicted, {});
  return recognition && recognition->is_accepted;
}

bool isRead(const Eye& eye, const Scene& scene, const cv::Mat& image) {
  const std::shared_ptr<const CameraModel> model(&eye.camera.model(), [](const CameraModel*) {});
  Localizer localizer(model, scene.map, {});
  Frame frame;
  frame.image = image;
  frame.base_from_camera = eye.camera.baseFromCamera();
  const FrameResult result = localizer.process(frame);
  const Marker& marker = scene.map.markers.front();
  return std::any_of(result.detections.begin(), result.detections.end(),
                     [&](const MarkerDetection& detection) {
                       return detection.id == marker.id && detection.family == marker.family;
                     });
}

/// Shares, by the width of a module.
struct Shares {
  std::array<double, kModules.size()> recognized{};
  std::array<double, kModules.size()> read{};
};

Shares sharesOf(const Eye& eye, const std::string& family, int draws) {
  constexpr double kNoise = 3.0;
  Shares shares;
  std::mt19937 generator(1);
  const double each = 1.0 / (draws * static_cast<double>(kIncidences.size()));
  bool recognizes = true;
  bool reads = true;
  for (std::size_t w = kModules.size(); w-- > 0 && (recognizes || reads);) {
    for (const double incidence : kIncidences) {
      for (int i = 0; i < draws; ++i) {
        const Scene scene = sceneOf(eye, family, kModules.at(w), incidence, &generator);
        const cv::Mat image =
            withGreyNoise(eye.renderer.render(scene.map, TagPatterns(scene.map), scene.walls, {}),
                          kNoise, generator());
        if (recognizes && isRecognized(eye, scene, image, &generator)) {
          shares.recognized.at(w) += each;
        }
        if (reads && isRead(eye, scene, image)) shares.read.at(w) += each;
      }
    }
    recognizes = recognizes && shares.recognized.at(w) >= 0.5;
    reads = reads && shares.read.at(w) >= 0.5;
  }
  return shares;
}

/// The least width at which nine of ten are; infinite where the largest is not enough.
double smallestOf(const std::array<double, kModules.size()>& shares) {
  constexpr double kEnough = 0.9 - 1e-9;
  const auto* const first =
      std::find_if(shares.begin(), shares.end(), [](double share) { return share >= kEnough; });
  return first == shares.end() ? std::numeric_limits<double>::infinity()
                               : kModules.at(static_cast<std::size_t>(first - shares.begin()));
}

void printShares(const char* eye, const std::string& family, const char* what,
                 const std::array<double, kModules.size()>& shares) {
  std::printf("%-20s %-8s %-11s", family.c_str(), eye, what);
  for (const double share : shares) std::printf(" %5.0f", 100.0 * share);
  std::printf("\n");
  std::fflush(stdout);
}

int run(int draws) {
  std::printf("%-20s %-8s %-11s", "percent, by pixels", "camera", "");
  for (const double module : kModules) std::printf(" %5.1f", module);
  std::printf("\n");
  const std::vector<Eye> all = eyes();
  std::vector<std::string> table;
  for (const std::string family : kFamilies) {
    double recognized = 0.0;
    double read = 0.0;
    for (const Eye& eye : all) {
      const Shares shares = sharesOf(eye, family, draws);
      printShares(eye.name, family, "recognized", shares.recognized);
      printShares(eye.name, family, "read", shares.read);
      recognized = std::max(recognized, smallestOf(shares.recognized));
      read = std::max(read, smallestOf(shares.read));
    }
    std::array<char, 80> line{};
    std::snprintf(line.data(), line.size(), "{\"%s\", {%.1f, %.1f}},", family.c_str(), recognized,
                  read);
    table.emplace_back(line.data());
  }
  std::printf("\n");
  for (const std::string& line : table) std::printf("%s\n", line.c_str());
  return 0;
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("family_study", [&] {
    constexpr int kDraws = 6;
    return omnitag::run(omnitag::countFrom(argc, argv, kDraws, 1));
  });
}
