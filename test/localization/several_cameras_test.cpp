#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "../support/level_floor.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

constexpr std::size_t kFront = 0;
constexpr std::size_t kBack = 1;

/// One of two fisheyes that share an image, half each.
std::shared_ptr<const CameraModel> halfOfDoubleImage(double cx) {
  return parseCamera(
      "{model: equidistant, image: {width: 1400, height: 700}, uncertainty: none, "
      "lens: {fx: 210, fy: 210, cx: " +
          std::to_string(cx) + ", cy: 349.5}, distortion: [0, 0, 0, 0], max_angle: 1.6}",
      "double");
}

/// A robot with a camera that looks ahead and one that looks behind.
class SeveralCamerasTest : public testing::Test {
 protected:
  /// Level, its optical axis at this heading of the robot.
  static Eigen::Isometry3d lookingAlong(double heading) {
    Eigen::Matrix3d base_from_optical;
    base_from_optical.col(0) = -Eigen::Vector3d::UnitY();
    base_from_optical.col(1) = -Eigen::Vector3d::UnitZ();
    base_from_optical.col(2) = Eigen::Vector3d::UnitX();
    Eigen::Isometry3d mounting = Eigen::Isometry3d::Identity();
    mounting.linear() =
        Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix() * base_from_optical;
    mounting.translation() = Eigen::Vector3d(0.1 * std::cos(heading), 0.0, 0.8);
    return mounting;
  }

  Frame frame(std::size_t camera, double stamp, const Pose& pose) const {
    const MountedCamera mounted(cameras_[camera].model, mountings_[camera]);
    Frame frame{stamp, test::renderPanorama(hung_, mounted, pose), mountings_[camera], {}};
    frame.camera = camera;
    return frame;
  }

  Localizer localizer() const { return {cameras_, map_, test::onLevelFloor()}; }

  static std::set<int> usedIds(const FrameResult& result) {
    std::set<int> ids;
    for (const MarkerDetection& detection : result.detections) {
      if (detection.accepted) ids.insert(detection.id);
    }
    return ids;
  }

  std::vector<LocalizerCamera> cameras_{{test::equidistantCamera()}, {test::equidistantCamera()}};
  std::vector<Eigen::Isometry3d> mountings_{lookingAlong(0.0), lookingAlong(kPi)};
  MarkerMap map_{"map", test::roomMarkers()};
  /// The markers that really hang in the room.
  MarkerMap hung_ = map_;
  Pose truth_{0.25, 0.22, 0.1};
};

TEST_F(SeveralCamerasTest, UpdateOneBelief) {
  // One marker ahead, one behind: alone, each leaves the robot uncertain along a different
  // direction.
  map_.markers = {map_.markers[1], map_.markers[5]};
  hung_ = map_;
  Localizer localizer = this->localizer();
  localizer.setPose(Pose{truth_.x + 0.03, truth_.y - 0.03, truth_.yaw + 0.02});
  const FrameResult ahead = localizer.process(frame(kFront, 1.0, truth_));
  const FrameResult behind = localizer.process(frame(kBack, 1.0, truth_));
  EXPECT_EQ(usedIds(ahead), std::set<int>{map_.markers[0].id});
  EXPECT_EQ(usedIds(behind), std::set<int>{map_.markers[1].id});
  ASSERT_TRUE(ahead.map_from_base && behind.map_from_base);
  EXPECT_LT(positionDeviation(*behind.map_from_base),
            0.5 * positionDeviation(*ahead.map_from_base));
  EXPECT_LT(test::positionError(behind.map_from_base->pose, truth_), 2e-3);
  EXPECT_LT(test::deviations(*behind.map_from_base, truth_), 4.0);
}

TEST_F(SeveralCamerasTest, AreFoundByEither) {
  for (const std::size_t camera : {kFront, kBack}) {
    Localizer localizer = this->localizer();
    const FrameResult found = localizer.process(frame(camera, 1.0, truth_));
    EXPECT_EQ(found.mode, Mode::kFound);
    const FrameResult next = localizer.process(frame(1 - camera, 1.02, truth_));
    EXPECT_EQ(next.mode, Mode::kTracking);
    ASSERT_TRUE(next.map_from_base);
    EXPECT_LT(test::positionError(next.map_from_base->pose, truth_), 2e-3);
  }
}

TEST_F(SeveralCamerasTest, FollowADriveWhoseImagesOvertakeEachOther) {
  Localizer localizer = this->localizer();
  localizer.setPose(truth_);
  const auto poseAt = [this](double time) {
    return Pose{truth_.x + 0.3 * time, truth_.y + 0.05 * time, truth_.yaw + 0.2 * time};
  };
  for (int i = 1; i <= 10; ++i) {
    // The image from behind was taken 30 ms before the one from ahead, and comes later.
    const double ahead = 0.1 * i;
    for (const auto& [camera, stamp] : {std::pair(kFront, ahead), std::pair(kBack, ahead - 0.03)}) {
      const FrameResult result = localizer.process(frame(camera, stamp, poseAt(stamp)));
      ASSERT_EQ(result.mode, Mode::kTracking);
      EXPECT_LT(test::positionError(result.map_from_base->pose, poseAt(stamp)), 3e-3);
      EXPECT_LT(test::deviations(*result.map_from_base, poseAt(stamp)), 5.0);
    }
  }
}

TEST_F(SeveralCamerasTest, OneThatSeesNothingCostsNoSearch) {
  // Nothing hangs behind the robot, neither in the map nor in the room.
  auto& markers = map_.markers;
  markers.erase(std::remove_if(markers.begin(), markers.end(),
                               [](const Marker& marker) { return marker.center().x() < 0.5; }),
                markers.end());
  hung_ = map_;
  Localizer localizer = this->localizer();
  localizer.setPose(truth_);
  const LocalizerConfig config = test::onLevelFloor();
  for (int i = 1; i <= 8; ++i) {
    const double stamp = 0.05 * i;
    EXPECT_EQ(localizer.process(frame(kFront, stamp, truth_)).mode, Mode::kTracking);
    const FrameResult behind = localizer.process(frame(kBack, stamp, truth_));
    EXPECT_EQ(behind.mode, Mode::kDeadReckoning);
    ASSERT_TRUE(behind.map_from_base);
    EXPECT_LT(test::positionError(behind.map_from_base->pose, truth_), 2e-3);
    // A view of the patrol at a time, none of a look all around.
    EXPECT_LE(behind.views.size(), 1U);
  }
  // Alone, it searches.
  Localizer alone({cameras_[kBack]}, map_, config);
  alone.setPose(truth_);
  Frame behind = frame(kBack, 1.0, truth_);
  behind.camera = 0;
  EXPECT_GT(alone.process(behind).views.size(), 1U);
}

TEST_F(SeveralCamerasTest, OneThatSeesMarkersElsewhereIsHeard) {
  // The robot was carried while a poster hid the view ahead.
  const Pose carried{-0.6, 0.9, 2.0};
  Localizer localizer = this->localizer();
  localizer.setPose(truth_);
  EXPECT_EQ(localizer.process(frame(kFront, 1.0, truth_)).mode, Mode::kTracking);
  EXPECT_EQ(localizer.process(frame(kBack, 1.0, truth_)).mode, Mode::kTracking);
  // At once, while the other camera's last image still counts.
  const FrameResult result = localizer.process(frame(kBack, 1.05, carried));
  ASSERT_TRUE(result.map_from_base);
  EXPECT_LT(test::positionError(result.map_from_base->pose, carried), 2e-3);
}

TEST_F(SeveralCamerasTest, WhatIsHiddenFromOneIsNotFromTheOther) {
  // Both look ahead, the second one past a mast.
  mountings_[kBack] = mountings_[kFront];
  Localizer localizer = this->localizer();
  localizer.setPose(truth_);
  const std::set<int> seen = usedIds(localizer.process(frame(kFront, 1.0, truth_)));
  ASSERT_GE(seen.size(), 3U);
  const MarkerMap whole = hung_;
  auto& markers = hung_.markers;
  markers.erase(std::find_if(markers.begin(), markers.end(),
                             [&](const Marker& marker) { return marker.id == *seen.begin(); }));
  for (const double stamp : {1.02, 1.04, 1.06}) {
    EXPECT_EQ(usedIds(localizer.process(frame(kBack, stamp, truth_))).count(*seen.begin()), 0U);
  }
  hung_ = whole;
  EXPECT_EQ(usedIds(localizer.process(frame(kFront, 1.1, truth_))), seen);
}

TEST_F(SeveralCamerasTest, ShareAnImageThatHoldsBoth) {
  cameras_ = {{halfOfDoubleImage(349.5)}, {halfOfDoubleImage(1049.5)}};
  cv::Mat image = frame(kFront, 1.0, truth_).image.clone();
  const cv::Rect right(700, 0, 700, 700);
  frame(kBack, 1.0, truth_).image(right).copyTo(image(right));
  for (const bool is_found : {true, false}) {
    Localizer localizer = this->localizer();
    if (!is_found) localizer.setPose(Pose{truth_.x + 0.04, truth_.y, truth_.yaw + 0.02});
    std::set<int> used;
    for (const std::size_t camera : {kFront, kBack}) {
      Frame both{1.0, image, mountings_[camera], {}};
      both.camera = camera;
      const FrameResult result = localizer.process(both);
      ASSERT_TRUE(result.map_from_base) << result.remark;
      EXPECT_LT(test::positionError(result.map_from_base->pose, truth_), 2e-3);
      const std::set<int> ids = usedIds(result);
      used.insert(ids.begin(), ids.end());
      for (const MarkerDetection& detection : result.detections) {
        EXPECT_EQ(detection.center.x() < 700.0, camera == kFront);
      }
    }
    EXPECT_GE(used.size(), 6U);
  }
}

TEST_F(SeveralCamerasTest, RefusesStampsThatFitNoStream) {
  Localizer localizer = this->localizer();
  localizer.setPose(truth_);
  localizer.process(frame(kFront, 2.0, truth_));
  localizer.process(frame(kBack, 2.0 - 0.9 * Localizer::kMaxOvertaken, truth_));
  const auto refuses = [&](std::size_t camera, double stamp) {
    EXPECT_THROW(localizer.process(frame(camera, stamp, truth_)), InputError) << stamp;
  };
  refuses(kFront, 2.0);
  refuses(kBack, 2.0 - 0.9 * Localizer::kMaxOvertaken);
  localizer.process(frame(kFront, 3.0, truth_));
  refuses(kBack, 3.0 - 1.1 * Localizer::kMaxOvertaken);
  // No matter how often images are overtaken.
  localizer.process(frame(kBack, 3.0 - 0.9 * Localizer::kMaxOvertaken, truth_));
  EXPECT_EQ(localizer.process(frame(kFront, 3.01, truth_)).mode, Mode::kTracking);
  Frame third = frame(kFront, 4.0, truth_);
  third.camera = 2;
  EXPECT_THROW(localizer.process(third), InputError);
  EXPECT_EQ(localizer.process(frame(kBack, 3.0, truth_)).mode, Mode::kTracking);
}

TEST_F(SeveralCamerasTest, KeepTheirStateInASuccessor) {
  Localizer before = this->localizer();
  before.setPose(truth_);
  before.process(frame(kFront, 1.0, truth_));
  before.process(frame(kBack, 1.1, truth_));
  Localizer after = this->localizer();
  after.continueFrom(before);
  EXPECT_THROW(after.process(frame(kFront, 1.0, truth_)), InputError);
  EXPECT_EQ(after.process(frame(kBack, 1.2, truth_)).mode, Mode::kTracking);
}

}  // namespace
}  // namespace omnitag
