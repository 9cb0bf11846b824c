#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "../support/level_floor.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "../support/sweep.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

/// A localizer that is replaced between two images by one with another map or other settings.
class SuccessionTest : public testing::Test {
 protected:
  FrameResult process(Localizer* localizer, const cv::Mat& image) {
    return localizer->process({0.1 * frames_++, image, mounting_, Pose{1.0, 2.0, 0.3}});
  }

  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
  Pose truth_{0.3, -0.2, 0.5};
  MarkerMap map_{"map", test::roomMarkers()};
  cv::Mat image_ = test::renderPanorama(map_, {camera_, mounting_}, truth_);
  cv::Mat black_ = cv::Mat::zeros(image_.size(), image_.type());
  int frames_ = 0;
};

TEST_F(SuccessionTest, KeepsThePoseThoughItSeesNothing) {
  Localizer before(camera_, map_, test::onLevelFloor());
  before.setPose(truth_);
  for (int i = 0; i < 3; ++i) process(&before, image_);
  MarkerMap other = map_;
  other.markers.erase(other.markers.begin(), other.markers.begin() + 3);
  LocalizerConfig config = test::onLevelFloor();
  config.estimation.kind = EstimatorKind::kReprojection;
  Localizer after(camera_, other, config);
  after.continueFrom(before);
  const FrameResult blind = process(&after, black_);
  EXPECT_EQ(blind.mode, Mode::kDeadReckoning);
  ASSERT_TRUE(blind.map_from_base);
  EXPECT_LT(test::positionError(blind.map_from_base->pose, truth_), 2e-3);
  EXPECT_EQ(process(&after, image_).mode, Mode::kTracking);
}

TEST_F(SuccessionTest, UsesTheOtherMap) {
  Localizer before(camera_, map_, test::onLevelFloor());
  before.setPose(truth_);
  const FrameResult with = process(&before, image_);
  ASSERT_GE(with.acceptedMarkers(), 5);
  // In reverse order.
  MarkerMap other{"map", {map_.markers.rbegin(), map_.markers.rend()}};
  other.markers.erase(other.markers.begin() + 2);
  Localizer after(camera_, other, test::onLevelFloor());
  after.continueFrom(before);
  const FrameResult result = process(&after, image_);
  EXPECT_EQ(result.mode, Mode::kTracking);
  EXPECT_LT(test::positionError(result.map_from_base->pose, truth_), 2e-3);
  for (const MarkerDetection& detection : result.detections) {
    if (!detection.accepted) continue;
    EXPECT_EQ(other.markers[*detection.map_entry].id, detection.id);
    EXPECT_NE(detection.id, map_.markers[map_.markers.size() - 3].id);
  }
}

TEST_F(SuccessionTest, KeepsAPoseThatWaitsForAnImage) {
  Localizer before(camera_, map_, test::onLevelFloor());
  before.setPose(truth_);
  Localizer after(camera_, map_, test::onLevelFloor());
  after.continueFrom(before);
  EXPECT_EQ(process(&after, image_).mode, Mode::kTracking);
}

TEST_F(SuccessionTest, GoesOnAHundredTimes) {
  auto localizer = std::make_unique<Localizer>(camera_, map_, test::onLevelFloor());
  localizer->setPose(truth_);
  MarkerMap fewer = map_;
  fewer.markers.pop_back();
  for (int i = 0; i < 100; i += test::kSweepStride) {
    ASSERT_EQ(process(localizer.get(), image_).mode, Mode::kTracking) << i;
    auto next =
        std::make_unique<Localizer>(camera_, i % 2 == 0 ? fewer : map_, test::onLevelFloor());
    next->continueFrom(*localizer);
    localizer = std::move(next);
  }
}

}  // namespace
}  // namespace omnitag
