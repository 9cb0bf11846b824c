#include "adjustment/pose_from_bearings.h"

#include <gtest/gtest.h>

#include <random>

#include "drive.h"
#include "omnitag/camera/camera_file.h"

namespace omnitag {
namespace {

using test::catadioptricFile;
using test::kSphere;

CalibrationFrame frameOf(const MarkerMap& map, const MountedCamera& truth, const Pose& pose) {
  CalibrationFrame frame;
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    const auto reading = test::exactReading(map.markers[i], truth, pose);
    if (reading) frame.observations.push_back({i, reading->corners, reading->center});
  }
  return frame;
}

class PoseFromBearingsTest : public testing::Test {
 protected:
  const MarkerMap map = test::roomMap();
  const MountedCamera truth{parseCamera(catadioptricFile(1195, 250, 250, 0.21, kSphere), "truth"),
                            test::mounting(1.1, 0.0, 0.0)};
  std::mt19937 generator{3};
};

TEST_F(PoseFromBearingsTest, NeedsNoMirror) {
  const MountedCamera guess(
      parseCamera(catadioptricFile(600, 250, 250, 0.4,
                                   "profile: parabolic, radius_of_curvature: 0.1, rim_radius: 0.1"),
                  "guess"),
      truth.baseFromCamera());
  for (const Pose& pose : test::posesInRoom(20, 2.5, &generator)) {
    const auto found = poseFromBearings(map, guess, frameOf(map, truth, pose));
    ASSERT_TRUE(found);
    EXPECT_LT(test::positionError(*found, pose), 0.02);
    EXPECT_NEAR(normalizeAngle(found->yaw - pose.yaw), 0.0, 0.02);
  }
}

TEST_F(PoseFromBearingsTest, IsNearWithACentreTenPixelsOff) {
  const MountedCamera guess(parseCamera(catadioptricFile(1195, 257, 243, 0.21, kSphere), "guess"),
                            truth.baseFromCamera());
  for (const Pose& pose : test::posesInRoom(20, 2.5, &generator)) {
    const auto found = poseFromBearings(map, guess, frameOf(map, truth, pose));
    ASSERT_TRUE(found);
    EXPECT_LT(test::positionError(*found, pose), 0.6);
    EXPECT_NEAR(normalizeAngle(found->yaw - pose.yaw), 0.0, radians(10.0));
  }
}

TEST_F(PoseFromBearingsTest, LeavesOutOneThatHangsElsewhere) {
  MarkerMap wrong = map;
  wrong.markers[3].map_from_marker.translation().x() -= 4.0;
  const Pose pose{0.3, -0.5, 1.0};
  const auto found = poseFromBearings(wrong, truth, frameOf(map, truth, pose));
  ASSERT_TRUE(found);
  EXPECT_LT(test::positionError(*found, pose), 0.02);
}

TEST_F(PoseFromBearingsTest, HasNoneWhereTheMapIsAnother) {
  MarkerMap other = map;
  // The markers swap places across the room.
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    const auto source = (7 * i + 3) % map.markers.size();
    other.markers[i].map_from_marker = map.markers[source].map_from_marker;
  }
  int found = 0;
  for (const Pose& pose : test::posesInRoom(20, 2.5, &generator)) {
    found += poseFromBearings(other, truth, frameOf(map, truth, pose)) ? 1 : 0;
  }
  EXPECT_LE(found, 10);
  CalibrationFrame two = frameOf(map, truth, {0.0, 0.0, 0.0});
  two.observations.resize(2);
  EXPECT_FALSE(poseFromBearings(map, truth, two));
}

}  // namespace
}  // namespace omnitag
