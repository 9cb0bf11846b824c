#include "adjustment/reading_alignment.h"

#include <gtest/gtest.h>

#include <random>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"

namespace omnitag {
namespace {

class ReadingAlignmentTest : public testing::Test {
 protected:
  static MarkerMap sampleMap() {
    return {"map",
            {test::wallMarker(0, {2.2, -0.6, 1.2}, kPi),
             test::wallMarker(1, {-0.7, 2.1, 1.0}, -kPi / 2),
             test::wallMarker(2, {-1.5, -1.4, 1.1}, 0.9)}};
  }

  /// As decoded: off by a few tenths of a pixel.
  std::vector<MarkerReading> roughReadings(const MarkerMap& map) const {
    std::mt19937 random(5);
    std::normal_distribution<double> normal(0.0, 0.15);
    std::vector<MarkerReading> readings;
    for (const Marker& marker : map.markers) {
      readings.push_back(*test::exactReading(marker, camera_, pose_));
      for (Eigen::Vector2d& corner : readings.back().corners) {
        corner += Eigen::Vector2d(normal(random), normal(random));
      }
    }
    return readings;
  }

  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
  Pose pose_{0.2, -0.1, 0.4};
};

TEST_F(ReadingAlignmentTest, PlacesCornersWhereTheyImage) {
  const MarkerMap map = sampleMap();
  const cv::Mat panorama = test::renderPanorama(map, camera_, pose_, 8);
  const auto aligned = alignReadings(panorama, map, TagPatterns(map), camera_, PosePrior::upright(),
                                     roughReadings(map));
  ASSERT_EQ(aligned.size(), map.markers.size());
  for (std::size_t i = 0; i < aligned.size(); ++i) {
    EXPECT_EQ(aligned[i].id, map.markers[i].id);
    const auto exact = test::exactReading(map.markers[i], camera_, pose_);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_LT((aligned[i].corners[k] - exact->corners[k]).norm(), 0.04) << i << ", " << k;
    }
  }
}

TEST_F(ReadingAlignmentTest, LeavesOutWhatTheMapDoesNotExplain) {
  const MarkerMap map = sampleMap();
  MarkerMap seen = map;
  seen.markers[2].id = 7;
  const cv::Mat panorama = test::renderPanorama(seen, camera_, pose_, 8);
  const auto aligned = alignReadings(panorama, map, TagPatterns(map), camera_, PosePrior::upright(),
                                     roughReadings(seen));
  ASSERT_EQ(aligned.size(), 2U);
  EXPECT_EQ(aligned[0].id, 0);
  EXPECT_EQ(aligned[1].id, 1);
}

TEST_F(ReadingAlignmentTest, LeavesOutMarkersWhosePixelsDoNotFit) {
  const MarkerMap map = sampleMap();
  MarkerMap seen = map;
  seen.markers.pop_back();
  const cv::Mat panorama = test::renderPanorama(seen, camera_, pose_, 8);
  EXPECT_EQ(alignReadings(panorama, map, TagPatterns(map), camera_, PosePrior::upright(),
                          roughReadings(map))
                .size(),
            2U);
}

}  // namespace
}  // namespace omnitag
