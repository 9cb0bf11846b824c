#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "../support/camera_in_room.h"
#include "../support/level_floor.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "../support/sweep.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

/// A camera that sees the whole sphere and looks ahead, as cameras with two fisheyes are mounted.
class PanoramaTest : public test::CameraInRoom {
 protected:
  PanoramaTest()
      : CameraInRoom(test::equirectangularCamera(), mounting(), {"map", test::roomMarkers()}) {}

  static Eigen::Isometry3d mounting() {
    Eigen::Matrix3d base_from_optical;
    base_from_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    return Eigen::Translation3d(0.05, 0.03, 1.2) *
           Eigen::AngleAxisd(0.03, Eigen::Vector3d(0.6, 0.8, 0.0)) *
           Eigen::Isometry3d(Eigen::Quaterniond(base_from_optical));
  }
};

TEST_F(PanoramaTest, TracksAllAround) {
  for (const double yaw : {0.5, -1.1, 2.6}) {
    truth_.yaw = yaw;
    Localizer localizer(model_, map_, test::onLevelFloor());
    localizer.setPose(Pose{truth_.x + 0.05, truth_.y - 0.04, truth_.yaw + 0.03});
    const FrameResult result = localizer.process(frame(1.0));
    EXPECT_EQ(result.mode, Mode::kTracking);
    // As with a fisheye of the same scale, one or two of ten markers 4 m away are doubted.
    EXPECT_GE(acceptedIds(result).size(), 7U);
    expectTruth(result);
  }
}

TEST_F(PanoramaTest, FindsItsPose) {
  for (const double yaw : {0.5, -1.1, 2.6}) {
    truth_.yaw = yaw;
    Localizer localizer(model_, map_, test::onLevelFloor());
    const FrameResult result = localizer.process(frame(1.0));
    EXPECT_EQ(result.mode, Mode::kFound);
    expectTruth(result);
  }
}

TEST_F(PanoramaTest, IsNotMisledByAMarkerAcrossItsSeam) {
  // Turned so that one marker after another is straight behind.
  for (std::size_t i = 0; i < map_.markers.size(); i += test::kSweepStride) {
    const Marker& marker = map_.markers[i];
    const Eigen::Vector3d to_marker = marker.center() - Eigen::Vector3d(truth_.x, truth_.y, 0.0);
    truth_.yaw = normalizeAngle(std::atan2(to_marker.y(), to_marker.x()) + kPi);
    Localizer localizer(model_, map_, test::onLevelFloor());
    localizer.setPose(Pose{truth_.x + 0.03, truth_.y - 0.02, truth_.yaw + 0.02});
    expectTruth(localizer.process(frame(1.0)));
  }
}

}  // namespace
}  // namespace omnitag
