#include "localization/triangulation.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

const Pose kTruth{1.2, -0.4, 2.5};
const std::vector<Eigen::Vector2d> kLandmarks{{4, 1}, {-3, 2}, {0.5, -5}, {2, 3.5}, {-2, -2}};

/// What a camera mounted at `viewpoint` on the robot sees of the landmarks.
std::vector<LandmarkBearing> sightsFrom(
    const Pose& pose, const Eigen::Vector2d& viewpoint,
    const std::vector<Eigen::Vector2d>& landmarks = kLandmarks) {
  std::vector<LandmarkBearing> sights;
  const Eigen::Vector2d eye =
      Eigen::Vector2d(pose.x, pose.y) + Eigen::Rotation2Dd(pose.yaw) * viewpoint;
  for (const Eigen::Vector2d& landmark : landmarks) {
    const Eigen::Vector2d way = landmark - eye;
    sights.push_back(
        {landmark, 0.0, viewpoint, std::atan2(way.y(), way.x()) - pose.yaw, 1e-3, 1.0});
  }
  return sights;
}

void expectPose(const PoseEstimate& estimate, const Pose& pose, double tolerance) {
  EXPECT_NEAR(estimate.pose.x, pose.x, tolerance);
  EXPECT_NEAR(estimate.pose.y, pose.y, tolerance);
  EXPECT_NEAR(normalizeAngle(estimate.pose.yaw - pose.yaw), 0.0, tolerance);
}

TEST(TriangulationTest, IsExactWithExactBearings) {
  for (const Eigen::Vector2d& viewpoint :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.3, -0.1), Eigen::Vector2d(-0.5, 0.8)}) {
    const auto estimate = triangulate(sightsFrom(kTruth, viewpoint), kTruth.yaw + 0.1);
    ASSERT_TRUE(estimate);
    expectPose(*estimate, kTruth, 1e-9);
  }
}

TEST(TriangulationTest, ConvergesFromHeadingsWithin45Degrees) {
  for (double error = -45.0; error <= 45.0; error += 5.0) {
    const auto estimate = triangulate(sightsFrom(kTruth, {0.1, 0}), kTruth.yaw + radians(error));
    ASSERT_TRUE(estimate) << error;
    expectPose(*estimate, kTruth, 1e-9);
  }
}

TEST(TriangulationTest, MinimisesTheSquaredDistancesOfEqn2) {
  std::vector<LandmarkBearing> sights = sightsFrom(kTruth, {0.2, 0.1});
  std::mt19937 generator(3);
  std::normal_distribution<double> noise(0.0, 0.02);
  for (LandmarkBearing& sight : sights) sight.bearing += noise(generator);
  const auto estimate = triangulate(sights, kTruth.yaw);
  ASSERT_TRUE(estimate);
  // Eqn 2 written out for the lines through the landmarks.
  const auto cost = [&sights](const Pose& pose) {
    double sum = 0.0;
    for (const LandmarkBearing& sight : sights) {
      const Eigen::Vector2d eye =
          Eigen::Vector2d(pose.x, pose.y) + Eigen::Rotation2Dd(pose.yaw) * sight.viewpoint;
      const double phi = pose.yaw + sight.bearing;
      const Eigen::Vector2d way = sight.landmark - eye;
      sum += std::pow(std::cos(phi) * way.y() - std::sin(phi) * way.x(), 2);
    }
    return sum;
  };
  const double least = cost(estimate->pose);
  constexpr double kStep = 1e-4;
  for (const double dx : {-kStep, 0.0, kStep}) {
    for (const double dy : {-kStep, 0.0, kStep}) {
      for (const double dyaw : {-kStep, 0.0, kStep}) {
        const Pose& p = estimate->pose;
        EXPECT_GE(cost({p.x + dx, p.y + dy, p.yaw + dyaw}), least);
      }
    }
  }
}

TEST(TriangulationTest, CovarianceMatchesTheSpreadOfManyTrials) {
  const double deviation = 2e-3;
  std::vector<LandmarkBearing> exact = sightsFrom(kTruth, {0.1, 0.05});
  for (LandmarkBearing& sight : exact) sight.bearing_deviation = deviation;
  const PoseEstimate expected = *triangulate(exact, kTruth.yaw);
  std::mt19937 generator(11);
  std::normal_distribution<double> noise(0.0, deviation);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  constexpr int kTrials = 4000;
  for (int i = 0; i < kTrials; ++i) {
    std::vector<LandmarkBearing> sights = exact;
    for (LandmarkBearing& sight : sights) sight.bearing += noise(generator);
    const Pose pose = triangulate(sights, kTruth.yaw)->pose;
    const Eigen::Vector3d error(pose.x - kTruth.x, pose.y - kTruth.y,
                                normalizeAngle(pose.yaw - kTruth.yaw));
    spread += error * error.transpose() / kTrials;
  }
  EXPECT_LT((spread - floorCovariance(expected)).norm(), 0.1 * spread.norm());
}

TEST(TriangulationTest, RefusesLandmarksBehind) {
  // All bearings reversed: the same lines, but every landmark lies behind.
  std::vector<LandmarkBearing> sights = sightsFrom(kTruth, {0, 0});
  for (LandmarkBearing& sight : sights) sight.bearing += kPi;
  EXPECT_FALSE(triangulate(sights, kTruth.yaw));
}

TEST(TriangulationTest, RefusesWhatIsUndetermined) {
  EXPECT_FALSE(triangulate({}, 0.0));
  EXPECT_FALSE(triangulate(sightsFrom(kTruth, {0, 0}, {{4, 1}, {-3, 2}}), kTruth.yaw));
  // The same landmark three times.
  EXPECT_FALSE(triangulate(sightsFrom(kTruth, {0, 0}, {{4, 1}, {4, 1}, {4, 1}}), kTruth.yaw));
}

TEST(TriangulationTest, ASightWithoutWeightDoesNotCount) {
  std::vector<LandmarkBearing> sights = sightsFrom(kTruth, {0.1, 0});
  sights[0].bearing += 0.2;
  sights[0].weight = 1e-12;
  const auto estimate = triangulate(sights, kTruth.yaw);
  ASSERT_TRUE(estimate);
  expectPose(*estimate, kTruth, 1e-6);
}

}  // namespace
}  // namespace omnitag
