#include "omnitag/common/pose.h"

#include <gtest/gtest.h>

#include <random>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

std::vector<Pose> samplePoses() {
  return {{1.0, -2.0, 0.7},
          {0.3, 0.2, -3.1, 0.5, 0.02, -0.01},
          {-1.0, 4.0, 2.0, -0.3, 1.2, -0.9},
          {0.0, 0.0, -0.4, 1.0, -2.5, 0.6}};
}

TEST(PoseTest, IsRotatedAboutXThenYThenZ) {
  for (const Pose& pose : samplePoses()) {
    const Eigen::Isometry3d expected = Eigen::Translation3d(pose.x, pose.y, pose.z) *
                                       Eigen::AngleAxisd(pose.yaw, Eigen::Vector3d::UnitZ()) *
                                       Eigen::AngleAxisd(pose.pitch, Eigen::Vector3d::UnitY()) *
                                       Eigen::AngleAxisd(pose.roll, Eigen::Vector3d::UnitX());
    EXPECT_TRUE(pose.toIsometry().isApprox(expected, 1e-14));
    EXPECT_TRUE(Pose::fromIsometry(expected).toIsometry().isApprox(expected, 1e-12));
  }
}

TEST(PoseTest, AChangeMovesAlongTheMapAndTurnsAboutTheBase) {
  std::mt19937 generator(1);
  std::normal_distribution<double> normal(0.0, 0.3);
  for (const Pose& pose : samplePoses()) {
    PoseVector change;
    for (int i = 0; i < 6; ++i) change[i] = normal(generator);
    const Eigen::Isometry3d before = pose.toIsometry();
    const Eigen::Isometry3d after = moved(pose, change).toIsometry();
    EXPECT_LT((after.translation() - before.translation() -
               Eigen::Vector3d(change[0], change[1], change[3]))
                  .norm(),
              1e-12);
    const Eigen::Vector3d turn(change[4], change[5], change[2]);
    const Eigen::Matrix3d expected =
        before.linear() * Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    EXPECT_TRUE(after.linear().isApprox(expected, 1e-12));
    EXPECT_LT((difference(moved(pose, change), pose) - change).norm(), 1e-9);
  }
}

TEST(PoseTest, OnTheFloorAChangeIsOneOfXYAndYaw) {
  const Pose a{1.0, 2.0, 3.0};
  const Pose b{0.5, 2.5, -3.0};
  const PoseVector change = difference(b, a);
  PoseVector expected;
  expected << -0.5, 0.5, 2.0 * kPi - 6.0, 0.0, 0.0, 0.0;
  EXPECT_LT((change - expected).norm(), 1e-12);
  const Pose back = moved(a, change);
  EXPECT_NEAR(back.yaw, b.yaw, 1e-12);
  EXPECT_EQ(back.roll, 0.0);
  EXPECT_EQ(back.pitch, 0.0);
}

TEST(PoseTest, CompositionIsThatOfTransforms) {
  const Pose a{0.3, 0.2, -3.1, 0.5, 0.2, -0.1};
  const Pose b{-1.0, 4.0, 2.0, -0.3, 1.2, -0.9};
  EXPECT_TRUE((a * b).toIsometry().isApprox(a.toIsometry() * b.toIsometry(), 1e-12));
  EXPECT_TRUE((a * inverse(a)).toIsometry().isApprox(Eigen::Isometry3d::Identity(), 1e-12));
}

}  // namespace
}  // namespace omnitag
