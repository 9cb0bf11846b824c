#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "../support/level_floor.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

/// Searches in rooms with randomly placed markers.
class SearchTest : public testing::Test {
 protected:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }

  /// Markers all around that roughly face the middle of the room.
  MarkerMap room(int count, double size, double nearest, double farthest) {
    MarkerMap map{"map", {}};
    const double first = uniform(0.0, 2.0 * kPi);
    for (int i = 0; i < count; ++i) {
      const double direction = first + 2.0 * kPi * (i + uniform(-0.25, 0.25)) / count;
      const double distance = uniform(nearest, farthest);
      Marker marker = test::wallMarker(
          3 * i,
          {distance * std::cos(direction), distance * std::sin(direction), uniform(0.8, 1.6)},
          direction + kPi + uniform(-0.4, 0.4));
      marker.size = size;
      map.markers.push_back(marker);
    }
    return map;
  }

  Pose pose() { return {uniform(-0.4, 0.4), uniform(-0.4, 0.4), uniform(-kPi, kPi)}; }

  FrameResult search(const MarkerMap& seen, const MarkerMap& map, const Pose& truth) const {
    Localizer localizer(model_, map, test::onLevelFloor());
    return localizer.process(
        {0.0, test::renderPanorama(seen, {model_, mounting_}, truth), mounting_, std::nullopt});
  }

  std::shared_ptr<const CameraModel> model_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
  std::mt19937 generator_{1};
};

TEST_F(SearchTest, FindsAllMarkersWhereTheFirstOnesTellLittle) {
  constexpr int kRooms = 60;
  constexpr int kMarkers = 8;
  int poses = 0;
  int incomplete = 0;
  for (int i = 0; i < kRooms; ++i) {
    const MarkerMap map = room(kMarkers, uniform(0.3, 0.5), 3.0, 4.5);
    const Pose truth = pose();
    const FrameResult result = search(map, map, truth);
    if (!result.map_from_base) continue;
    ++poses;
    if (result.acceptedMarkers() < kMarkers) ++incomplete;
  }
  EXPECT_GE(poses, 54);
  EXPECT_LE(incomplete, 2);
}

TEST_F(SearchTest, WhatWasMovedAsOneAndIsSeenBestDoesNotTakeTheRobotAlong) {
  // Four of nine are moved; the others are smaller in the image.
  MarkerMap map{"map",
                {test::wallMarker(0, {-1.73, -1.82, 0.81}, 0.66),
                 test::wallMarker(3, {0.24, -2.27, 0.85}, 1.41),
                 test::wallMarker(6, {1.76, -2.03, 1.34}, 2.30),
                 test::wallMarker(9, {2.74, -0.69, 0.99}, 2.96),
                 test::wallMarker(12, {1.60, 1.36, 1.04}, -2.79),
                 test::wallMarker(15, {0.55, 2.16, 1.52}, -1.44),
                 test::wallMarker(18, {-1.25, 2.68, 1.07}, -1.36),
                 test::wallMarker(21, {-3.12, 1.16, 1.20}, 0.07),
                 test::wallMarker(24, {-2.23, -0.24, 1.04}, 0.28)}};
  const Pose truth{0.107, 0.345, -2.896};
  MarkerMap seen = map;
  for (std::size_t i = 0; i < 4; ++i) {
    Marker& moved = seen.markers[i];
    moved.map_from_marker = Eigen::Translation3d(0.132, -0.101, 0.0) * moved.map_from_marker;
  }
  const FrameResult result = search(seen, map, truth);
  if (result.map_from_base) {
    EXPECT_LT(test::positionError(result.map_from_base->pose, truth), 3e-3);
  } else {
    EXPECT_NE(result.remark.find("explain what was read about equally well"), std::string::npos)
        << result.remark;
  }
}

}  // namespace
}  // namespace omnitag
