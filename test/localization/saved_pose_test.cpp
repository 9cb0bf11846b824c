#include "localization/saved_pose.h"

#include <gtest/gtest.h>

#include "../support/level_floor.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

SavedPose sample() {
  PoseMatrix root = PoseMatrix::Random();
  SavedPose saved{"hall", 1234567890.123456789, {{1.25, -3.5, 2.0, 0.1, 0.02, -0.03}, {}, {}}};
  saved.map_from_base.covariance = root * root.transpose();
  return saved;
}

std::string refusal(const std::string& text) {
  try {
    parseSavedPose(text, "pose.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SavedPoseTest, IsReadAsItWasWritten) {
  const SavedPose saved = sample();
  const SavedPose read = parseSavedPose(textOf(saved), "pose.yaml");
  EXPECT_EQ(read.map_frame, "hall");
  EXPECT_NEAR(read.stamp, saved.stamp, 1e-6);
  EXPECT_LT(difference(read.map_from_base.pose, saved.map_from_base.pose).norm(), 1e-9);
  EXPECT_TRUE(read.map_from_base.covariance.isApprox(saved.map_from_base.covariance, 1e-8));
}

TEST(SavedPoseTest, RefusesWhatIsNoPose) {
  const std::string text = textOf(sample());
  EXPECT_NE(refusal(text.substr(0, text.find("covariance"))).find("covariance"), std::string::npos);
  EXPECT_NE(refusal(text.substr(0, text.size() - 30)), "");
  std::string broken = text;
  broken.replace(broken.find("1.25"), 4, ".nan");
  EXPECT_NE(refusal(broken).find("pose.yaml:4: pose"), std::string::npos) << refusal(broken);
  EXPECT_NE(refusal(""), "");
}

class StartingTest : public testing::Test {
 protected:
  FrameResult startAt(const Pose& saved, const Pose& truth) {
    Localizer localizer(camera_, map_, test::onLevelFloor());
    const PoseEstimate last = floorEstimate(saved, 1e-8 * Eigen::Matrix3d::Identity());
    localizer.setPose(afterAPause(last, 0.1, radians(5.0)));
    const cv::Mat image = test::renderPanorama(map_, {camera_, mounting_}, truth);
    FrameResult result;
    for (int i = 0; i < 3; ++i) result = localizer.process({0.1 * i, image, mounting_, {}});
    return result;
  }

  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
  MarkerMap map_{"map", test::roomMarkers()};
};

TEST_F(StartingTest, FindsARobotThatStandsWhereItStopped) {
  const Pose truth{0.3, -0.2, 0.5};
  const FrameResult result = startAt({0.35, -0.26, 0.53}, truth);
  ASSERT_TRUE(result.map_from_base);
  EXPECT_LT(test::positionError(result.map_from_base->pose, truth), 2e-3);
}

TEST_F(StartingTest, FindsARobotThatWasCarriedOffMeanwhile) {
  const Pose truth{0.3, -0.2, 0.5};
  const FrameResult result = startAt({-1.9, 1.2, -2.0}, truth);
  ASSERT_TRUE(result.map_from_base) << result.remark;
  EXPECT_LT(test::positionError(result.map_from_base->pose, truth), 2e-3);
}

}  // namespace
}  // namespace omnitag
