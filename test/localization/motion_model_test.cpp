#include "localization/motion_model.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

namespace omnitag {
namespace {

PoseEstimate certain(const Pose& pose) {
  return floorEstimate(pose, 1e-6 * Eigen::Matrix3d::Identity());
}

TEST(MotionModelTest, LearnsTheVelocityOfACircle) {
  // 0.8 m/s around a circle of 2 m.
  const double turn_rate = 0.4;
  const auto onCircle = [turn_rate](double t) {
    return Pose{2.0 * std::sin(turn_rate * t), -2.0 * std::cos(turn_rate * t), turn_rate * t};
  };
  MotionModel motion{{}};
  motion.reset(certain(onCircle(0.0)), 0.0, std::nullopt);
  PoseEstimate predicted;
  for (int i = 1; i <= 20; ++i) {
    predicted = motion.predict(0.1 * i, std::nullopt);
    const Pose truth = onCircle(0.1 * i);
    const Eigen::Vector2d error(predicted.pose.x - truth.x, predicted.pose.y - truth.y);
    if (i > 3) {
      EXPECT_LT(error.norm(), 0.005) << i;
      EXPECT_NEAR(predicted.pose.yaw, truth.yaw, 0.005) << i;
    }
    motion.correct(certain(truth));
  }
}

TEST(MotionModelTest, UnknownVelocityMakesTheFirstPredictionUncertain) {
  MotionModelConfig config;
  MotionModel motion{config};
  motion.reset(certain({}), 0.0, std::nullopt);
  const PoseEstimate predicted = motion.predict(0.5, std::nullopt);
  // sigma^2 = (0.5 s * speed)^2 + (0.5 s^2 / 2 * acceleration)^2 + the pose's own
  const double expected = std::pow(0.5 * config.initial_speed_deviation, 2) +
                          std::pow(0.125 * config.acceleration_deviation, 2) + 1e-6;
  EXPECT_NEAR(predicted.covariance(0, 0), expected, 1e-9);
}

TEST(MotionModelTest, FollowsOdometryWhateverItsFrame) {
  const Pose map_from_odom{3.0, -1.0, 2.0};
  MotionModel motion{{}};
  const Pose first{0.2, 0.1, 0.3};
  const Pose second{0.6, -0.1, -0.4};
  motion.reset(certain(map_from_odom * first), 0.0, first);
  const PoseEstimate predicted = motion.predict(0.1, second);
  const Pose expected = map_from_odom * second;
  EXPECT_NEAR(predicted.pose.x, expected.x, 1e-12);
  EXPECT_NEAR(predicted.pose.y, expected.y, 1e-12);
  EXPECT_NEAR(predicted.pose.yaw, expected.yaw, 1e-12);
}

TEST(MotionModelTest, OdometryAtRestAddsNoUncertainty) {
  MotionModel motion{{}};
  motion.reset(certain({}), 0.0, Pose{});
  for (int i = 1; i < 100; ++i) motion.predict(i, Pose{});
  EXPECT_TRUE(motion.isTrustworthy());
  EXPECT_NEAR(floorCovariance(motion.predict(100.0, Pose{})).norm(), 1e-6 * std::sqrt(3.0), 1e-12);
}

TEST(MotionModelTest, CovarianceStaysPositiveDefinite) {
  MotionModel motion{{}};
  motion.reset(certain({1, 2, 3}), 0.0, std::nullopt);
  for (int i = 1; i < 500; ++i) {
    const PoseEstimate predicted = motion.predict(0.05 * i, std::nullopt);
    const Eigen::SelfAdjointEigenSolver<PoseMatrix> eigen(predicted.covariance);
    ASSERT_GT(eigen.eigenvalues()(0), 0.0) << i;
    motion.correct({predicted.pose, 0.01 * predicted.covariance});
  }
}

TEST(MotionModelTest, WithoutOdometryItIsTrustedForASecond) {
  MotionModel motion{{}};
  motion.reset(certain({}), 0.0, std::nullopt);
  for (int i = 1; i <= 5; ++i) {
    motion.predict(0.1 * i, std::nullopt);
    motion.correct(certain({0.05 * i, 0, 0}));
  }
  motion.predict(0.9, std::nullopt);
  EXPECT_TRUE(motion.isTrustworthy());
  motion.predict(1.6, std::nullopt);
  EXPECT_FALSE(motion.isTrustworthy());
}

/// As RViz's "2D Pose Estimate" sends it by default.
PoseEstimate pointedAt(const Pose& pose) {
  return floorEstimate(pose,
                       Eigen::Vector3d(0.25, 0.25, radians(15.0) * radians(15.0)).asDiagonal());
}

TEST(MotionModelTest, APoseFromOutsideIsKeptForTenSecondsWithoutOdometry) {
  MotionModel motion{{}};
  motion.resetToGiven(pointedAt({1, 2, 3}), 0.0, std::nullopt);
  for (int i = 0; i <= 100; ++i) {
    motion.predict(0.1 * i, std::nullopt);
    ASSERT_TRUE(motion.isTrustworthy()) << i;
  }
  motion.predict(10.2, std::nullopt);
  EXPECT_FALSE(motion.isTrustworthy());
}

TEST(MotionModelTest, OdometryCarriesAPoseFromOutsideUntilItIsTwoMetresOff) {
  MotionModel motion{{}};
  motion.resetToGiven(pointedAt({1, 2, 0}), 0.0, Pose{});
  double deviation = 0.0;
  for (int i = 1; deviation <= 2.0; ++i) {
    const PoseEstimate predicted = motion.predict(i, Pose{0.5 * i, 0, 0});
    // The robot drives along x: the heading's error moves it along y.
    deviation = std::sqrt(predicted.covariance(1, 1));
    ASSERT_EQ(motion.isTrustworthy(), deviation <= 2.0) << i << ": " << deviation;
    ASSERT_LT(i, 100);
  }
}

TEST(MotionModelTest, APoseThatAMarkerConfirmedIsNoLongerFromOutside) {
  MotionModel motion{{}};
  motion.resetToGiven(pointedAt({1, 2, 3}), 0.0, std::nullopt);
  motion.predict(0.1, std::nullopt);
  motion.correct(certain({1, 2, 3}));
  motion.predict(1.5, std::nullopt);
  EXPECT_FALSE(motion.isTrustworthy());
}

TEST(MotionModelTest, AFreePoseMustBeCertainInAllSix) {
  const double at_stamp = 0.0;
  for (const int i : {3, 4, 5}) {
    PoseEstimate estimate = certain({});
    estimate.covariance(i, i) = 1.0;
    for (const PoseModel model : {PoseModel::kFloor, PoseModel::kFree}) {
      MotionModelConfig config;
      config.pose_model = model;
      MotionModel motion{config};
      motion.reset(estimate, at_stamp, std::nullopt);
      EXPECT_EQ(motion.isTrustworthy(), model == PoseModel::kFloor) << i;
    }
  }
}

TEST(MotionModelTest, OdometryThatIsMissingOnceDoesNotEndAPose) {
  MotionModel motion{{}};
  motion.reset(certain({}), 0.0, Pose{});
  for (int i = 1; i <= 50; ++i) motion.predict(0.1 * i, Pose{});
  motion.predict(5.1, std::nullopt);
  EXPECT_TRUE(motion.isTrustworthy());
  motion.predict(5.2, Pose{});
  motion.predict(5.3, Pose{});
  EXPECT_TRUE(motion.isTrustworthy());
  for (int i = 1; i <= 11; ++i) motion.predict(5.3 + 0.1 * i, std::nullopt);
  EXPECT_FALSE(motion.isTrustworthy());
}

}  // namespace
}  // namespace omnitag
