#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "../support/sweep.h"
#include "omnitag/common/angle.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

/// A free robot with a spherical mirror, among markers.
class FreeRobotTest : public testing::Test {
 protected:
  FreeRobotTest() { config_.motion.pose_model = PoseModel::kFree; }

  Frame frameFrom(const Pose& truth, double stamp) const {
    constexpr int kSamples = 8;
    return {stamp, test::renderPanorama(map_, MountedCamera(camera_, mounting_), truth, kSamples),
            mounting_, std::nullopt};
  }

  /// Leaning by up to 25 degrees, with any heading.
  Pose randomPose() {
    const auto within = [this](double limit) { return limit * uniform_(generator_); };
    return {within(1.0), within(1.0),         within(kPi),
            within(0.6), within(radians(25)), within(radians(25))};
  }

  /// Expects a pose that is right, and within its covariance.
  static void expectTruth(const PoseEstimate& estimate, const Pose& truth) {
    const PoseVector error = difference(estimate.pose, truth);
    // Chi-square with 6 degrees of freedom: beyond 33 is one of a hundred thousand.
    EXPECT_LT(error.dot(estimate.covariance.ldlt().solve(error)), 33.0);
    EXPECT_LT(translationPart(error).norm(), 0.02);
    EXPECT_LT(rotationPart(error).norm(), radians(0.5));
  }

  /// Expects a search to find the robot at this many random poses.
  void expectFoundAnywhere(int poses) {
    for (int i = 0; i < poses; ++i) {
      const Pose truth = randomPose();
      if (i % test::kSweepStride != 0) continue;
      Localizer localizer(camera_, map_, config_);
      const FrameResult result = localizer.process(frameFrom(truth, 0.0));
      ASSERT_TRUE(result.map_from_base) << i << ": " << result.remark;
      EXPECT_EQ(result.mode, Mode::kFound);
      expectTruth(*result.map_from_base, truth);
    }
  }

  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
  MarkerMap map_{"map", test::markersAround(3.5, 0.8)};
  LocalizerConfig config_;
  std::mt19937 generator_{12};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

TEST_F(FreeRobotTest, IsFoundFromNothing) {
  constexpr int kPoses = 12;
  for (const EstimatorKind kind : {EstimatorKind::kPhotometric, EstimatorKind::kReprojection}) {
    config_.estimation.kind = kind;
    expectFoundAnywhere(kPoses);
  }
}

TEST_F(FreeRobotTest, IsFoundFromNothingByAFisheye) {
  camera_ = test::equidistantCamera();
  mounting_ = test::lookingUp();
  expectFoundAnywhere(4);
}

TEST_F(FreeRobotTest, IsFoundByViewsOfAllThatTheCameraSees) {
  config_.look_around.glance = false;
  expectFoundAnywhere(4);
}

TEST_F(FreeRobotTest, ASingleMarkerIsNeverTakenForItsMirrorImage) {
  const std::vector<Marker> all = map_.markers;
  for (std::size_t i = 0; i < all.size(); ++i) {
    map_.markers = {all[i]};
    const Pose truth = randomPose();
    Localizer localizer(camera_, map_, config_);
    const FrameResult result = localizer.process(frameFrom(truth, 0.0));
    if (!result.map_from_base) continue;
    const PoseVector error = difference(result.map_from_base->pose, truth);
    EXPECT_LT(error.dot(result.map_from_base->covariance.ldlt().solve(error)), 33.0) << i;
  }
}

TEST_F(FreeRobotTest, APushUpwardThatOdometryDoesNotFeelIsFollowedAtOnce) {
  Localizer localizer(camera_, map_, config_);
  Pose truth{0.1, -0.2, 0.5, 0.1, radians(5.0), radians(-8.0)};
  PoseEstimate start{truth};
  start.covariance = 1e-4 * PoseMatrix::Identity();
  localizer.setPose(start);
  double stamp = 0.0;
  const auto next = [&] {
    Frame frame = frameFrom(truth, stamp);
    frame.odom_from_base = Pose{1.0, 2.0, 3.0, 0.0, truth.roll, truth.pitch};
    stamp += 0.1;
    return localizer.process(frame);
  };
  for (int i = 0; i < 20; ++i) next();
  for (const double way : {0.01, 0.03}) {
    truth.z += way;
    next();
    const FrameResult result = next();
    ASSERT_TRUE(result.map_from_base) << result.remark;
    expectTruth(*result.map_from_base, truth);
    EXPECT_LT(std::abs(result.map_from_base->pose.z - truth.z), 0.2 * way);
  }
}

}  // namespace
}  // namespace omnitag
