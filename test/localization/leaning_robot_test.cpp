#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <memory>
#include <random>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "omnitag/common/angle.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

/// A leaning robot with a spherical mirror, among markers.
class LeaningRobotTest : public testing::Test {
 protected:
  Frame frameFrom(const Pose& truth, double stamp) const {
    constexpr int kSamples = 8;
    return {stamp, test::renderPanorama(map_, MountedCamera(camera_, mounting_), truth, kSamples),
            mounting_, std::nullopt};
  }

  /// Expects a pose that is right, and within its covariance.
  static void expectTruth(const PoseEstimate& estimate, const Pose& truth) {
    const PoseVector error = difference(estimate.pose, truth);
    // Chi-square with 6 degrees of freedom: beyond 33 is one of a hundred thousand.
    EXPECT_LT(error.dot(estimate.covariance.ldlt().solve(error)), 33.0);
    EXPECT_LT(error.head<2>().norm(), 6e-3);
    EXPECT_LT(std::abs(error[2]), radians(0.05));
    EXPECT_LT(error.tail<2>().norm(), radians(0.1));
  }

  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
  MarkerMap map_{"map", test::markersAround(3.5, 0.8)};
};

TEST_F(LeaningRobotTest, IsLocalizedOnAFloorAndToldToBeInItsPlane) {
  Localizer localizer(camera_, map_, {});
  std::mt19937 generator(2);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (int i = 0; i < 5; ++i) {
    const Pose truth{0.1 * i,
                     0.2,
                     0.3 + 0.05 * i,
                     0.004 * normal(generator),
                     radians(0.7) * normal(generator),
                     radians(0.7) * normal(generator)};
    if (i == 0) localizer.setPose(truth.onFloor());
    const FrameResult result = localizer.process(frameFrom(truth, 0.1 * i));
    ASSERT_TRUE(result.map_from_base) << i;
    EXPECT_EQ(result.mode, Mode::kTracking);
    EXPECT_EQ(result.acceptedMarkers(), 8);
    expectTruth(*result.map_from_base, truth);
    const PoseEstimate published = result.publishedPose();
    EXPECT_EQ(published.pose.x, result.map_from_base->pose.x);
    EXPECT_EQ(published.pose.z, 0.0);
    EXPECT_EQ(published.pose.roll, 0.0);
    EXPECT_EQ(published.pose.pitch, 0.0);
    EXPECT_GT(published.covariance(4, 4), 0.0);
  }
}

TEST_F(LeaningRobotTest, IsFoundBySearch) {
  const Pose truth{0.4, -0.3, 1.0, -0.006, radians(0.8), radians(-0.5)};
  Localizer localizer(camera_, map_, {});
  const FrameResult result = localizer.process(frameFrom(truth, 0.0));
  ASSERT_TRUE(result.map_from_base) << result.remark;
  EXPECT_EQ(result.mode, Mode::kFound);
  expectTruth(*result.map_from_base, truth);
}

TEST_F(LeaningRobotTest, OdometryThatTellsTheLeanIsBelieved) {
  // It leans much more than the floor should allow, and there are only two markers.
  map_.markers.resize(2);
  const Pose truth{0.4, -0.3, 1.0, 0.0, radians(6.0), radians(-5.0)};
  Localizer localizer(camera_, map_, {});
  localizer.setPose(Pose{0.42, -0.31, 1.01});
  Frame frame = frameFrom(truth, 0.0);
  frame.odom_from_base = Pose{3.0, 1.0, -2.0, 0.0, truth.roll, truth.pitch};
  const FrameResult result = localizer.process(frame);
  ASSERT_TRUE(result.map_from_base) << result.remark;
  EXPECT_EQ(result.acceptedMarkers(), 2);
  const PoseVector error = difference(result.map_from_base->pose, truth);
  EXPECT_LT(error.head<2>().norm(), 0.03);
  EXPECT_LT(error.tail<2>().norm(), radians(1.0));
}

TEST_F(LeaningRobotTest, AllSixNumbersAreWantedWhereItIsFree) {
  LocalizerConfig config;
  config.motion.pose_model = PoseModel::kFree;
  Localizer localizer(camera_, map_, config);
  Pose truth{0.0, 0.2, 0.3, 0.1, radians(4.0), radians(-3.0)};
  localizer.setPose(truth);
  for (int i = 0; i < 5; ++i) {
    truth = {0.05 * i,         0.2, 0.3 + 0.04 * i, 0.1 + 0.03 * i, radians(4.0 + 1.5 * i),
             radians(-3.0 + i)};
    const FrameResult result = localizer.process(frameFrom(truth, 0.1 * i));
    ASSERT_TRUE(result.map_from_base) << i;
    EXPECT_EQ(result.mode, Mode::kTracking) << i;
    expectTruth(*result.map_from_base, truth);
    const PoseEstimate published = result.publishedPose();
    EXPECT_NEAR(published.pose.z, truth.z, 0.01);
    EXPECT_NEAR(published.pose.roll, truth.roll, radians(0.1));
    EXPECT_NEAR(published.pose.pitch, truth.pitch, radians(0.1));
  }
}

TEST_F(LeaningRobotTest, APushThatTheWheelsDoNotFeelIsFollowedAtOnce) {
  Localizer localizer(camera_, map_, {});
  Pose truth{0.1, -0.2, 0.5};
  localizer.setPose(truth);
  const Pose odometry{1.0, 2.0, 3.0};
  double stated = 0.0;
  Frame frame = frameFrom(truth, 0.0);
  for (int i = 0; i < 40; ++i) {
    frame.stamp = 0.1 * i;
    frame.odom_from_base = odometry;
    const FrameResult result = localizer.process(frame);
    ASSERT_TRUE(result.map_from_base);
    const double deviation = positionDeviation(*result.map_from_base);
    if (i == 0) {
      stated = deviation;
    } else {
      EXPECT_GT(deviation, 0.4 * stated) << i << ": the same pixels err the same";
    }
  }
  for (const double way : {0.004, 0.01, 0.03}) {
    truth.x += way;
    frame = frameFrom(truth, frame.stamp);
    for (int i = 0; i < 3; ++i) {
      frame.stamp += 0.1;
      frame.odom_from_base = odometry;
      const FrameResult result = localizer.process(frame);
      ASSERT_TRUE(result.map_from_base);
      if (i < 2) continue;
      const PoseVector error = difference(result.map_from_base->pose, truth);
      EXPECT_LT(error.head<2>().norm(),
                std::max(0.2 * way, 4.0 * positionDeviation(*result.map_from_base)));
    }
  }
}

}  // namespace
}  // namespace omnitag
