#include "adjustment/map_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

const Pose kOtherFromMap{12.0, -7.0, 2.1};

std::vector<PosePair> drive(int count, double position_noise, double heading_noise,
                            std::mt19937* generator) {
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<PosePair> pairs;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * i / count;
    const Pose here{3.0 * std::cos(angle), 2.0 * std::sin(angle), normalizeAngle(angle + 1.0)};
    Pose there = kOtherFromMap * here;
    there.x += position_noise * normal(*generator);
    there.y += position_noise * normal(*generator);
    there.yaw += heading_noise * normal(*generator);
    pairs.push_back({here, there});
  }
  return pairs;
}

TEST(MapAlignmentTest, DeviationsAreThoseOfManyDrives) {
  constexpr int kDrives = 200;
  std::mt19937 generator(3);
  double position = 0.0;
  double heading = 0.0;
  double stated_position = 0.0;
  double stated_heading = 0.0;
  for (int i = 0; i < kDrives; ++i) {
    const MapAlignment fit = alignByPoses(drive(60, 0.04, 0.02, &generator));
    // The middle of the path is the map's origin.
    position += std::pow(fit.other_from_map.x - kOtherFromMap.x, 2) +
                std::pow(fit.other_from_map.y - kOtherFromMap.y, 2);
    heading += std::pow(normalizeAngle(fit.other_from_map.yaw - kOtherFromMap.yaw), 2);
    stated_position += std::pow(fit.positionDeviation(), 2);
    stated_heading += std::pow(fit.headingDeviation(), 2);
    EXPECT_NEAR(fit.position_residual, std::sqrt(2.0) * 0.04, 0.015);
  }
  EXPECT_NEAR(std::sqrt(stated_position / position), 1.0, 0.3);
  EXPECT_NEAR(std::sqrt(stated_heading / heading), 1.0, 0.3);
}

TEST(MapAlignmentTest, ErrorsThatLastCountOnce) {
  // Errors like amcl's: the same for ten poses.
  std::mt19937 generator(4);
  std::normal_distribution<double> normal(0.0, 0.04);
  const auto lasting = [&](std::vector<PosePair> pairs) {
    double x = 0.0;
    double y = 0.0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (i % 10 == 0) {
        x = normal(generator);
        y = normal(generator);
      }
      pairs[i].in_other.x += x;
      pairs[i].in_other.y += y;
    }
    return alignByPoses(pairs).positionDeviation();
  };
  const double deviation = lasting(drive(200, 0.0, 0.001, &generator));
  EXPECT_GT(deviation, 0.6 * std::sqrt(2.0) * 0.04 / std::sqrt(20.0));
}

TEST(MapAlignmentTest, ALostLocalizerDoesNotCount) {
  std::mt19937 generator(5);
  std::vector<PosePair> pairs = drive(60, 0.01, 0.005, &generator);
  for (std::size_t i = 20; i < 35; ++i) pairs[i].in_other.x += 4.0;
  const MapAlignment fit = alignByPoses(pairs);
  EXPECT_LT(
      std::hypot(fit.other_from_map.x - kOtherFromMap.x, fit.other_from_map.y - kOtherFromMap.y),
      0.01);
  EXPECT_LE(fit.agreeing, 45U);
  EXPECT_GT(fit.agreeing, 35U);
  EXPECT_EQ(fit.all, 60U);
}

TEST(MapAlignmentTest, TwoPointsByHand) {
  const auto there = [](double x, double y) {
    const Pose pose = kOtherFromMap * Pose{x, y, 0.0};
    return Eigen::Vector2d(pose.x, pose.y);
  };
  std::vector<PointPair> points = {{{0.0, 0.0}, there(0.0, 0.0)}, {{4.0, 3.0}, there(4.0, 3.0)}};
  const MapAlignment exact = alignByPoints(points);
  EXPECT_NEAR(exact.other_from_map.x, kOtherFromMap.x, 1e-12);
  EXPECT_NEAR(exact.other_from_map.y, kOtherFromMap.y, 1e-12);
  EXPECT_NEAR(exact.other_from_map.yaw, kOtherFromMap.yaw, 1e-12);
  // 5 m in one map are 5.02 m in the other: each end is 1 cm off.
  points[1].in_other += 0.02 * (points[1].in_other - points[0].in_other).normalized();
  EXPECT_NEAR(alignByPoints(points).position_residual, 0.01, 1e-9);
  EXPECT_NEAR(alignByPoints(points).other_from_map.yaw, kOtherFromMap.yaw, 1e-9);
}

TEST(MapAlignmentTest, RefusesTooLittle) {
  EXPECT_THROW(alignByPoses({}), InputError);
  EXPECT_THROW(alignByPoints({{{0.0, 0.0}, {1.0, 1.0}}}), InputError);
  EXPECT_THROW(alignByPoints({{{0.0, 0.0}, {1.0, 1.0}}, {{0.1, 0.0}, {1.1, 1.0}}}), InputError);
}

}  // namespace
}  // namespace omnitag
