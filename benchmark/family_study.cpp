// How small a marker of each family may be in the image: the width of a module (of a picture: of a
// feature, TagPattern::featureWidth()), in pixels along the marker's longest edge, at which nine of
// ten markers are
//
//   recognized   where they are predicted, 5 mm and 0.1 degrees off (standard deviations), as after
//                the first markers of an image
//   read         in a search, without a prediction
//
// on average over the incidences and a draw of places around the robot, in the worse of two
// cameras: the mirror of the paper's experiment and a fisheye of 500 x 500. Images have noise of 3
// grey levels and no blur; a marker is 2.5 m away, on a wall. Then the same for markers with
// modules of 4 pixels, by the incidence. The last lines are the table of
// src/planning/family_limits.cpp. Pictures are those of maps/paper_artoolkit.yaml.
//
//   family_study [DRAWS] [FAMILY]...     DRAWS for each size and incidence, 6 by default

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "marker/marker_prediction.h"
#include "marker/tag_pattern.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/marker/marker_map_file.h"
#include "photometry/recognition.h"
#include "prediction.h"
#include "program.h"
#include "room_renderer.h"

namespace omnitag {
namespace {

constexpr std::array<const char*, 12> kFamilies{"tag36h11",
                                                "tag25h9",
                                                "tag16h5",
                                                "tagStandard41h12",
                                                "tagStandard52h13",
                                                "tagCircle21h7",
                                                "DICT_4X4_50",
                                                "DICT_5X5_100",
                                                "DICT_6X6_250",
                                                "DICT_7X7_250",
                                                "DICT_ARUCO_ORIGINAL",
                                                kPictureFamily};
constexpr std::array<double, 13> kModules{0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.4,
                                          1.6, 1.8, 2.0, 2.4, 2.8, 3.4};
constexpr std::array<double, 3> kIncidences{0.0, 30.0, 50.0};  // degrees

// How aslant markers with modules of 4 pixels may be.
constexpr double kSteepModule = 4.0;
constexpr std::array<double, 8> kSteep{50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0};

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

/// The markers of a family from which one is drawn: some ids, or all pictures.
std::vector<Marker> markersOf(const std::string& family) {
  std::vector<Marker> markers;
  if (family == kPictureFamily) {
    const MarkerMap map = loadMarkerMap(PACKAGE_DIR "/maps/paper_artoolkit.yaml");
    for (std::size_t i = 0; i < map.markers.size(); ++i) {
      if (map.markers[i].id == static_cast<int>(i)) markers.push_back(map.markers[i]);
    }
    return markers;
  }
  constexpr int kIds = 20;
  for (int id = 0; id < kIds; ++id) {
    Marker marker;
    marker.family = family;
    marker.id = id;
    markers.push_back(marker);
  }
  return markers;
}

/// A marker whose modules are so wide in the image, and the wall behind it.
struct Scene {
  MarkerMap map;
  std::vector<Wall> walls;
};

Scene sceneOf(const Eye& eye, const std::vector<Marker>& markers, double module, double incidence,
              std::mt19937* generator) {
  constexpr double kDistance = 2.5;  // m
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double direction = 2.0 * kPi * uniform(*generator);
  const double side = uniform(*generator) < 0.5 ? -1.0 : 1.0;
  const auto number =
      static_cast<std::size_t>(static_cast<double>(markers.size()) * uniform(*generator));
  Marker marker = markers[number];
  const Eigen::Vector2d place(kDistance * std::cos(direction), kDistance * std::sin(direction));
  const double yaw = direction + kPi + side * radians(incidence);
  marker.map_from_marker =
      Eigen::Translation3d(place.x(), place.y(), 1.0 + 0.6 * uniform(*generator)) *
      uprightOrientation(yaw, 0.0);
  const TagPattern pattern(marker);
  const double modules = pattern.widthBetweenCorners() / pattern.featureWidth();
  VisibilityConfig any;
  any.min_edge_pixels = 0.0;
  any.max_incidence = 0.5 * kPi;
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
  const auto recognition =
      recognize(image, marker, TagPattern(marker), eye.camera, predicted_pose.pose, *predicted, {});
  return recognition && recognition->is_accepted;
}

/// Against all markers of the family: those that are not there are a kilometre away.
bool isRead(const Eye& eye, const Scene& scene, std::vector<Marker> markers, const cv::Mat& image) {
  const Marker& marker = scene.map.markers.front();
  MarkerMap map = scene.map;
  for (Marker& other : markers) {
    if (other.id == marker.id) continue;
    other.size = marker.size;
    other.map_from_marker = Eigen::Translation3d(1000.0, 0.0, 0.0) * marker.map_from_marker;
    map.markers.push_back(other);
  }
  const std::shared_ptr<const CameraModel> model(&eye.camera.model(), [](const CameraModel*) {});
  Localizer localizer(model, map, {});
  Frame frame;
  frame.image = image;
  frame.base_from_camera = eye.camera.baseFromCamera();
  const FrameResult result = localizer.process(frame);
  return std::any_of(result.detections.begin(), result.detections.end(),
                     [&](const MarkerDetection& detection) {
                       return detection.id == marker.id && detection.family == marker.family;
                     });
}

/// How markers are looked at: the width of a module in pixels, and incidences in degrees.
struct Look {
  double module;
  std::vector<double> incidences;
};

/// Shares of the markers that are found, by the look.
struct Shares {
  std::vector<double> recognized;
  std::vector<double> read;
};

/// `looks`: the easiest first; where most are missed, those that follow are not tried.
Shares sharesOf(const Eye& eye, const std::vector<Marker>& markers, const std::vector<Look>& looks,
                int draws) {
  constexpr double kNoise = 3.0;
  Shares shares{std::vector<double>(looks.size()), std::vector<double>(looks.size())};
  std::mt19937 generator(1);
  bool recognizes = true;
  bool reads = true;
  for (std::size_t k = 0; k < looks.size() && (recognizes || reads); ++k) {
    const double each = 1.0 / (draws * static_cast<double>(looks[k].incidences.size()));
    for (const double incidence : looks[k].incidences) {
      for (int i = 0; i < draws; ++i) {
        const Scene scene = sceneOf(eye, markers, looks[k].module, incidence, &generator);
        const cv::Mat image =
            withGreyNoise(eye.renderer.render(scene.map, TagPatterns(scene.map), scene.walls, {}),
                          kNoise, generator());
        if (recognizes && isRecognized(eye, scene, image, &generator)) shares.recognized[k] += each;
        if (reads && isRead(eye, scene, markers, image)) shares.read[k] += each;
      }
    }
    recognizes = recognizes && shares.recognized[k] >= 0.5;
    reads = reads && shares.read[k] >= 0.5;
  }
  return shares;
}

/// Index of the hardest look at which nine of ten are found; nothing if there is none.
std::optional<std::size_t> hardestOf(const std::vector<double>& shares) {
  constexpr double kEnough = 0.9 - 1e-9;
  const auto last =
      std::find_if(shares.rbegin(), shares.rend(), [](double share) { return share >= kEnough; });
  if (last == shares.rend()) return std::nullopt;
  return static_cast<std::size_t>(shares.rend() - last) - 1;
}

void printShares(const std::string& family, const char* eye, const char* what,
                 const std::vector<double>& shares) {
  std::printf("%-20s %-8s %-11s", family.c_str(), eye, what);
  for (const double share : shares) std::printf(" %5.0f", 100.0 * share);
  std::printf("\n");
  std::fflush(stdout);
}

/// Of each family, the hardest look in the worse camera at which markers are recognized, and read.
using Hardest = std::pair<std::optional<std::size_t>, std::optional<std::size_t>>;

std::vector<Hardest> study(const std::vector<Eye>& eyes, const std::vector<std::string>& families,
                           const std::vector<Look>& looks, int draws) {
  std::vector<Hardest> hardest;
  for (const std::string& family : families) {
    const std::vector<Marker> markers = markersOf(family);
    Hardest of_family(looks.size() - 1, looks.size() - 1);
    for (const Eye& eye : eyes) {
      const Shares shares = sharesOf(eye, markers, looks, draws);
      printShares(family, eye.name, "recognized", shares.recognized);
      printShares(family, eye.name, "read", shares.read);
      // Nothing is less than any number.
      of_family.first = std::min(of_family.first, hardestOf(shares.recognized));
      of_family.second = std::min(of_family.second, hardestOf(shares.read));
    }
    hardest.push_back(of_family);
  }
  return hardest;
}

int run(int draws, const std::vector<std::string>& families) {
  const std::vector<Eye> all = eyes();
  std::vector<Look> by_width;
  for (std::size_t w = kModules.size(); w-- > 0;) {
    by_width.push_back({kModules.at(w), {kIncidences.begin(), kIncidences.end()}});
  }
  std::printf("%-20s %-8s %-11s", "percent, by pixels", "camera", "");
  for (const Look& look : by_width) std::printf(" %5.1f", look.module);
  std::printf("\n");
  const std::vector<Hardest> smallest = study(all, families, by_width, draws);

  std::vector<Look> by_incidence;
  for (const double incidence : kSteep) by_incidence.push_back({kSteepModule, {incidence}});
  std::printf("\n%-20s %-8s %-11s", "percent, by degrees", "camera", "");
  for (const double incidence : kSteep) std::printf(" %5.0f", incidence);
  std::printf("\n");
  const std::vector<Hardest> steepest = study(all, families, by_incidence, draws);

  const auto moduleAt = [&](const std::optional<std::size_t>& look) {
    return look ? by_width[*look].module : std::numeric_limits<double>::infinity();
  };
  const auto incidenceAt = [&](const std::optional<std::size_t>& look) {
    return look ? by_incidence[*look].incidences.front() : 0.0;
  };
  std::printf("\n");
  for (std::size_t f = 0; f < families.size(); ++f) {
    std::printf("{\"%s\", {%.1f, %.1f}},  // up to %.0f, %.0f degrees\n", families[f].c_str(),
                moduleAt(smallest[f].first), moduleAt(smallest[f].second),
                incidenceAt(steepest[f].first), incidenceAt(steepest[f].second));
  }
  return 0;
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  return omnitag::runProgram("family_study", [&] {
    constexpr int kDraws = 6;
    const int draws = omnitag::countFrom(std::min(argc, 2), argv, kDraws, 1);
    std::vector<std::string> families(argv + std::min(argc, 2), argv + argc);
    if (families.empty()) families.assign(omnitag::kFamilies.begin(), omnitag::kFamilies.end());
    return omnitag::run(draws, families);
  });
}
