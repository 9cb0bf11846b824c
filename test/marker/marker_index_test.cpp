#include "marker/marker_index.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "marker/marker_prediction.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

MarkerMap randomMap(std::size_t count) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> place(-30.0, 30.0);
  MarkerMap map{"map", {}};
  for (std::size_t i = 0; i < count; ++i) {
    map.markers.push_back(test::wallMarker(static_cast<int>(i % 500),
                                           {place(generator), place(generator), 1.2},
                                           0.1 * place(generator)));
  }
  return map;
}

TEST(MarkerIndexTest, FindsThoseWithinTheRange) {
  const MarkerMap map = randomMap(400);
  const MarkerIndex index(map);
  const Eigen::Vector3d point(3.0, -8.0, 1.0);
  for (const double range : {0.0, 2.0, 9.5, 25.0, 200.0}) {
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < map.markers.size(); ++i) {
      if ((map.markers[i].center() - point).norm() <= range) expected.push_back(i);
    }
    EXPECT_EQ(index.within(range, point), expected) << range;
  }
  EXPECT_TRUE(MarkerIndex(MarkerMap{"map", {}}).within(10.0, point).empty());
}

TEST(MarkerIndexTest, KnowsHowHighMarkersReach) {
  Marker upright = test::wallMarker(1, {2.0, 1.0, 1.2}, 0.7);
  Marker turned = test::wallMarker(2, {-3.0, 1.0, 2.0}, 0.1);
  upright.size = turned.size = 0.2;
  // A corner up: its diagonal is upright.
  turned.map_from_marker.rotate(Eigen::AngleAxisd(radians(45.0), Eigen::Vector3d::UnitZ()));
  const MarkerMap map{"map",
                      {upright, turned, test::lyingMarker(3, {0.0, 0.0, 2.8}, false, 0.0, 0.4)}};
  const MarkerIndex index(map);
  const MarkerHeights& heights = index.heights();
  EXPECT_NEAR(heights.upright.low, 1.2 - 1.2 * 0.1, 1e-12);
  EXPECT_NEAR(heights.upright.high, 2.0 + 1.2 * 0.1 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(heights.lying.low, 2.8, 1e-12);
  EXPECT_NEAR(heights.lying.high, 2.8, 1e-12);
  EXPECT_TRUE(heightsOf({"map", {upright}}).lying.isEmpty());
  EXPECT_TRUE(heightsOf({"map", {}}).upright.isEmpty());
}

TEST(MarkerIndexTest, PredictsWhatLookingAtEachMarkerPredicts) {
  const MarkerMap map = randomMap(3000);
  const MarkerIndex index(map);
  const MountedCamera camera(test::sphericalCamera(), test::lookingDown());
  const VisibilityConfig config;
  int seen = 0;
  for (int i = 0; i < 20; ++i) {
    const PoseEstimate pose{{2.0 * i - 20.0, 15.0 - 1.5 * i, 0.3 * i},
                            1e-4 * PoseMatrix::Identity()};
    std::vector<std::size_t> expected;
    for (std::size_t entry = 0; entry < map.markers.size(); ++entry) {
      if (predictMarker(map, entry, camera, pose, config)) expected.push_back(entry);
    }
    std::vector<std::size_t> found;
    for (const PredictedMarker& marker : predictMarkers(map, index, camera, pose, config)) {
      found.push_back(marker.map_entry);
    }
    EXPECT_EQ(found, expected);
    seen += static_cast<int>(found.size());
  }
  EXPECT_GT(seen, 20);
}

}  // namespace
}  // namespace omnitag
