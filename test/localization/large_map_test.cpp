#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>

#include "../support/level_floor.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/marker/marker_map_file.h"

namespace omnitag {
namespace {

constexpr int kRoomsPerSide = 25;
constexpr int kMarkersPerRoom = 16;
constexpr double kRoom = 10.0;  // m
constexpr std::size_t kHere = 12 * kRoomsPerSide + 7;

/// 625 rooms in a square, with four markers on each wall, out of the 587 of the family.
std::string buildingFile() {
  std::mt19937 random(1);
  std::ostringstream file;
  file.precision(12);
  file << "family: tag36h11\nsize: 0.8\nmarkers:\n";
  for (int room = 0; room < kRoomsPerSide * kRoomsPerSide; ++room) {
    const double x = kRoom * (room % kRoomsPerSide);
    const double y = kRoom * (room / kRoomsPerSide);
    for (int i = 0; i < kMarkersPerRoom; ++i) {
      const double wall = 0.5 * kPi * (i / 4);
      const double along = 2.0 * (i % 4) - 3.0 + 0.1 * static_cast<double>(random() % 10);
      const double away = 0.45 * kRoom;
      file << "  - {id: " << random() % 587 << ", position: ["
           << x + away * std::cos(wall) - along * std::sin(wall) << ", "
           << y + away * std::sin(wall) + along * std::cos(wall) << ", "
           << 0.9 + 0.1 * static_cast<double>(random() % 8) << "], yaw: " << wall + kPi << "}\n";
    }
  }
  return file.str();
}

class LargeMapTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { building() = parseMarkerMap(buildingFile(), "building.yaml"); }
  static MarkerMap& building() {
    static MarkerMap map;
    return map;
  }

  /// The robot drives through one room, whose walls hide all others.
  static Pose routeAt(int frame) {
    const double x = kRoom * (kHere % kRoomsPerSide);
    const double y = kRoom * (kHere / kRoomsPerSide);
    return {x + 0.7 + 0.08 * frame, y - 0.4 + 0.05 * frame, 0.4 + 0.06 * frame};
  }
  Frame frameAt(int index) const {
    const auto first = building().markers.begin() + kHere * kMarkersPerRoom;
    const MarkerMap room{"map", {first, first + kMarkersPerRoom}};
    return {0.1 * index, test::renderPanorama(room, {camera_, mounting_}, routeAt(index)),
            mounting_, std::nullopt};
  }
  static void expectPose(const FrameResult& result, int index) {
    ASSERT_TRUE(result.map_from_base) << result.remark;
    const Eigen::Vector3d error = difference(result.map_from_base->pose, routeAt(index)).head<3>();
    EXPECT_LT(error.head<2>().norm(), 5e-3);
    EXPECT_LT(std::abs(error.z()), 1e-3);
    for (const MarkerDetection& detection : result.detections) {
      if (detection.accepted) {
        EXPECT_EQ(*detection.map_entry / kMarkersPerRoom, kHere);
      }
    }
  }

  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
};

TEST_F(LargeMapTest, LoadsEveryMarker) {
  EXPECT_EQ(building().markers.size(), 10000U);
  EXPECT_GT(entriesOf(building(), "tag36h11", building().markers[0].id).size(), 1U);
}

TEST_F(LargeMapTest, Tracks) {
  Localizer localizer(camera_, building(), test::onLevelFloor());
  localizer.setPose(routeAt(0));
  for (int i = 0; i < 3; ++i) {
    const FrameResult result = localizer.process(frameAt(i));
    EXPECT_EQ(result.mode, Mode::kTracking);
    EXPECT_GE(result.acceptedMarkers(), 5);
    expectPose(result, i);
  }
}

TEST_F(LargeMapTest, FindsTheRoomAmongAll) {
  Localizer localizer(camera_, building(), test::onLevelFloor());
  expectPose(localizer.process(frameAt(0)), 0);
}

}  // namespace
}  // namespace omnitag
