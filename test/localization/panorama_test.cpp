#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "../support/level_floor.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "../support/sweep.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

/// A camera of the whole sphere that looks ahead, as those of two fisheyes are mounted.
class PanoramaTest : public testing::Test {
 protected:
  static Eigen::Isometry3d mounting() {
    Eigen::Matrix3d base_from_optical;
    base_from_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    return Eigen::Translation3d(0.05, 0.03, 1.2) *
           Eigen::AngleAxisd(0.03, Eigen::Vector3d(0.6, 0.8, 0.0)) *
           Eigen::Isometry3d(Eigen::Quaterniond(base_from_optical));
  }

  Frame frame(double stamp) const {
    return {stamp, test::renderPanorama(map_, camera_, truth_), camera_.baseFromCamera(),
            std::nullopt};
  }

  static std::set<int> acceptedIds(const FrameResult& result) {
    std::set<int> ids;
    for (const MarkerDetection& detection : result.detections) {
      if (detection.accepted) ids.insert(detection.id);
    }
    return ids;
  }

  void expectTruth(const FrameResult& result) const {
    ASSERT_TRUE(result.map_from_base) << result.remark;
    EXPECT_LT(test::positionError(result.map_from_base->pose, truth_), 2e-3);
    EXPECT_NEAR(result.map_from_base->pose.yaw, truth_.yaw, 5e-4);
  }

  std::shared_ptr<const CameraModel> model_ = test::equirectangularCamera();
  MountedCamera camera_{model_, mounting()};
  MarkerMap map_{"map", test::roomMarkers()};
  Pose truth_{0.25, 0.22, 0.5};
};

TEST_F(PanoramaTest, TracksAllAround) {
  for (const double yaw : {0.5, -1.1, 2.6}) {
    truth_.yaw = yaw;
    Localizer localizer(model_, map_, test::onLevelFloor());
    localizer.setPose(Pose{truth_.x + 0.05, truth_.y - 0.04, truth_.yaw + 0.03});
    const FrameResult result = localizer.process(frame(1.0));
    EXPECT_EQ(result.mode, Mode::kTracking);
    // As by a fisheye of the same scale, one or two of ten that are 4 m away are doubted.
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
  // Turned so that each marker in its turn is straight behind.
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
