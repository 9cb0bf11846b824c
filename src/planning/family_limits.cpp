#include "planning/family_limits.h"

#include <algorithm>
#include <cmath>

#include "marker/marker_prediction.h"
#include "marker/tag_pattern.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// A distance (m), and the longest edge that a marker has in the image from there (pixels).
struct SeenFrom {
  double distance = 0.0;
  double edge = 0.0;
};

/// In one direction from the camera, from far to near; where the marker is seen.
std::vector<SeenFrom> seenAlong(const MountedCamera& camera, double direction, double size,
                                double height) {
  constexpr double kFarthest = 100.0;
  constexpr double kRatio = 0.985;
  constexpr int kSteps = 410;  // down to 0.2 m
  VisibilityConfig any;
  any.max_range = 2.0 * kFarthest;
  any.min_edge_pixels = 0.0;
  const Eigen::Vector3d viewpoint = camera.mapFromCamera({}).translation();
  MarkerMap map;
  map.markers.resize(1);
  Marker& marker = map.markers.front();
  marker.size = size;
  std::vector<SeenFrom> seen;
  double distance = kFarthest;
  for (int step = 0; step < kSteps; ++step) {
    marker.map_from_marker =
        Eigen::Translation3d(viewpoint.x() + distance * std::cos(direction),
                             viewpoint.y() + distance * std::sin(direction), height) *
        uprightOrientation(direction + kPi, 0.0);
    const auto predicted = predictMarker(map, 0, camera, {}, any);
    if (predicted) seen.push_back({distance, longestEdge(predicted->corners)});
    distance *= kRatio;
  }
  return seen;
}

/// The median over the directions in which it is seen.
double reachOf(const std::vector<std::vector<SeenFrom>>& directions, double least_edge) {
  std::vector<double> reaches;
  for (const std::vector<SeenFrom>& seen : directions) {
    if (seen.empty()) continue;
    const auto farthest = std::find_if(
        seen.begin(), seen.end(), [&](const SeenFrom& from) { return from.edge >= least_edge; });
    reaches.push_back(farthest == seen.end() ? 0.0 : farthest->distance);
  }
  if (reaches.empty()) return 0.0;
  const auto middle = reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2);
  std::nth_element(reaches.begin(), middle, reaches.end());
  return *middle;
}

/// Of a family's markers: how many modules lie between the corners (of pictures: features), and the
/// width of the whole drawing, as a share of that.
struct Layout {
  int modules = 0;
  double printed = 1.0;
};

Layout layoutOf(const std::string& family) {
  if (family != kPictureFamily) {
    const TagPattern pattern(family, 0);
    const int modules = pattern.widthBetweenCorners();
    return {modules, static_cast<double>(pattern.width()) / modules};
  }
  // The median of the patterns in maps/patterns, which are drawn like any picture with ARToolKit's
  // border.
  constexpr int kFeatures = 8;
  constexpr int kCells = 16;
  PatternPicture picture;
  picture.side = kCells;
  for (int i = 0; i < kCells * kCells; ++i) picture.white.push_back((i / kCells + i) % 2);
  const TagPattern pattern(picture);
  return {kFeatures, static_cast<double>(pattern.width()) / pattern.widthBetweenCorners()};
}

}  // namespace

const std::vector<FamilyLimits>& measuredFamilies() {
  // What family_study prints.
  static const std::vector<FamilyLimits> limits{
      {"tag36h11", {0.9, 1.8}},
      {"tag25h9", {1.0, 1.8}},
      {"tag16h5", {1.1, 1.8}},
      {"tagStandard41h12", {1.0, 2.4}},
      {"tagStandard52h13", {0.9, 2.4}},
      {"tagCircle21h7", {1.1, 2.0}},
      {"DICT_4X4_50", {1.1, 2.0}},
      {"DICT_5X5_100", {1.0, 1.8}},
      {"DICT_6X6_250", {0.9, 1.8}},
      {"DICT_7X7_250", {0.8, 2.0}},
      {"DICT_ARUCO_ORIGINAL", {1.0, 2.0}},
      {kPictureFamily, {1.0, 2.8}},
  };
  return limits;
}

SmallestModules smallestModulesOf(const std::string& family) {
  const std::vector<FamilyLimits>& all = measuredFamilies();
  const auto found = std::find_if(
      all.begin(), all.end(), [&](const FamilyLimits& limits) { return limits.family == family; });
  return found == all.end() ? all.front().smallest : found->smallest;
}

std::vector<FamilyReach> familyReaches(const MountedCamera& camera, double size, double height) {
  constexpr int kDirections = 36;
  std::vector<std::vector<SeenFrom>> directions;
  directions.reserve(kDirections);
  for (int i = 0; i < kDirections; ++i) {
    directions.push_back(seenAlong(camera, 2.0 * kPi * i / kDirections, size, height));
  }
  std::vector<FamilyReach> reaches;
  reaches.reserve(measuredFamilies().size());
  for (const FamilyLimits& limits : measuredFamilies()) {
    FamilyReach reach;
    reach.family = limits.family;
    const Layout layout = layoutOf(limits.family);
    reach.modules = layout.modules;
    reach.printed_width = size * layout.printed;
    reach.smallest = limits.smallest;
    // What is smaller is not looked for.
    constexpr VisibilityConfig kLimits;
    reach.recognized = reachOf(
        directions, std::max(kLimits.min_edge_pixels, reach.modules * limits.smallest.recognized));
    reach.read = reachOf(directions, std::max(kLimits.min_decodable_edge_pixels,
                                              reach.modules * limits.smallest.read));
    reaches.push_back(reach);
  }
  return reaches;
}

}  // namespace omnitag
