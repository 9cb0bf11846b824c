#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "../support/camera_in_room.h"
#include "../support/level_floor.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

struct Setup {
  std::string name;
  std::shared_ptr<const CameraModel> (*camera)();
  bool looks_up;
};

/// Names a setup for gtest.
void PrintTo(const Setup& setup, std::ostream* out) { *out << setup.name; }

/// A fisheye that looks up from near the floor, or down from near the ceiling, a little tilted.
class FisheyeTest : public test::CameraInRoom, public testing::WithParamInterface<Setup> {
 protected:
  FisheyeTest()
      : CameraInRoom(GetParam().camera(), mountingOf(GetParam().looks_up),
                     mapOf(GetParam().looks_up)) {}

  static Eigen::Isometry3d mountingOf(bool looks_up) {
    const Eigen::Isometry3d level =
        Eigen::Translation3d(0.08, -0.04, looks_up ? 0.5 : 2.2) *
        Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(looks_up ? 0.0 : kPi, Eigen::Vector3d::UnitX());
    return level * Eigen::AngleAxisd(0.04, Eigen::Vector3d(0.6, 0.8, 0.0));
  }

  /// Three markers on walls, and some on the ceiling or the floor, one of them right above or below
  /// the camera.
  static MarkerMap mapOf(bool looks_up) {
    std::vector<Marker> markers = test::roomMarkers();
    MarkerMap map{"map", {markers[1], markers[3], markers[6]}};
    const double height = looks_up ? 2.7 : 0.0;
    const std::vector<Eigen::Vector2d> places = {{0.3, 0.2}, {1.6, -0.9}, {-1.2, 0.8}, {0.4, 1.9}};
    for (std::size_t i = 0; i < places.size(); ++i) {
      map.markers.push_back(test::lyingMarker(20 + static_cast<int>(i),
                                              {places[i].x(), places[i].y(), height}, !looks_up,
                                              0.9 * static_cast<double>(i) - 0.4, 0.5));
    }
    return map;
  }

  std::set<int> all_{1, 3, 6, 20, 21, 22, 23};
};

TEST_P(FisheyeTest, TracksWithMarkersAboveBelowAndAround) {
  Localizer localizer(model_, map_, test::onLevelFloor());
  localizer.setPose(Pose{truth_.x + 0.05, truth_.y - 0.04, truth_.yaw + 0.03});
  const FrameResult result = localizer.process(frame(1.0));
  EXPECT_EQ(result.mode, Mode::kTracking);
  EXPECT_EQ(acceptedIds(result), all_);
  expectTruth(result);
}

TEST_P(FisheyeTest, FindsThemAllAround) {
  Localizer localizer(model_, map_, test::onLevelFloor());
  const FrameResult result = localizer.process(frame(1.0));
  EXPECT_EQ(result.mode, Mode::kFound);
  EXPECT_EQ(acceptedIds(result), all_);
  expectTruth(result);
}

TEST_P(FisheyeTest, TracksByTheOneRightAboveOrBelow) {
  map_.markers = {map_.markers[3]};
  Localizer localizer(model_, map_, test::onLevelFloor());
  localizer.setPose(Pose{truth_.x + 0.02, truth_.y - 0.02, truth_.yaw + 0.01});
  const FrameResult result = localizer.process(frame(1.0));
  EXPECT_EQ(acceptedIds(result), std::set<int>{20});
  ASSERT_TRUE(result.map_from_base);
  EXPECT_LT(test::positionError(result.map_from_base->pose, truth_), 5e-3);
}

INSTANTIATE_TEST_SUITE_P(, FisheyeTest,
                         testing::Values(Setup{"EquidistantUp", test::equidistantCamera, true},
                                         Setup{"EquidistantDown", test::equidistantCamera, false},
                                         Setup{"UnifiedUp", test::unifiedCamera, true},
                                         Setup{"UnifiedDown", test::unifiedCamera, false},
                                         Setup{"DoubleSphereUp", test::doubleSphereCamera, true},
                                         Setup{"EucmDown", test::eucmCamera, false},
                                         Setup{"OcamUp", test::ocamCamera, true},
                                         Setup{"OcamDown", test::ocamCamera, false}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace omnitag
