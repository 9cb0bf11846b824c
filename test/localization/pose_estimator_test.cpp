#include "localization/pose_estimator.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "../support/sample_cameras.h"

namespace omnitag {
namespace {

/// Markers on the walls of a room of 8 m, seen from inside.
class PoseEstimatorTest : public testing::Test {
 protected:
  PoseEstimatorTest() {
    for (int i = 0; i < 10; ++i) {
      const double direction = 2.0 * kPi * i / 10 + 0.2 * (i % 3);
      Marker marker;
      marker.family = "tag36h11";
      marker.id = i;
      marker.size = 0.8;
      marker.map_from_marker = Eigen::Translation3d(4.0 * std::cos(direction),
                                                    4.0 * std::sin(direction), 1.0 + 0.06 * i) *
                               uprightOrientation(direction + kPi, 0.0);
      map_.markers.push_back(marker);
    }
  }

  std::vector<MarkerObservation> observe(const std::vector<std::size_t>& entries,
                                         double noise = 0.0) {
    std::normal_distribution<double> normal(0.0, 1.0);
    const auto measured = [&](const Eigen::Vector3d& point) -> Eigen::Vector2d {
      const Eigen::Vector2d error(normal(generator_), normal(generator_));
      return *camera_.pixelFromMap(truth_, point) + noise * error;
    };
    std::vector<MarkerObservation> observations;
    for (const std::size_t entry : entries) {
      MarkerObservation observation;
      observation.map_entry = entry;
      const Corners<Eigen::Vector3d> corners = map_.markers[entry].corners();
      for (std::size_t k = 0; k < corners.size(); ++k) {
        observation.corners[k] = measured(corners[k]);
      }
      observation.center = measured(map_.markers[entry].center());
      observations.push_back(observation);
    }
    return observations;
  }

  Eigen::Vector3d error(const Pose& pose) const {
    return {pose.x - truth_.x, pose.y - truth_.y, normalizeAngle(pose.yaw - truth_.yaw)};
  }

  static PosePrior prior(const Pose& pose, double position, double heading) {
    PoseEstimate estimate{pose};
    estimate.covariance.diagonal().head<3>() << position * position, position * position,
        heading * heading;
    return PosePrior::about(estimate);
  }

  MarkerMap map_{"map", {}};
  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
  Pose truth_{0.7, -0.9, 1.3};
  EstimatorConfig config_;
  std::mt19937 generator_{5};
};

TEST_F(PoseEstimatorTest, TriangulationTakesBearingsAsALeaningRobotHasThem) {
  config_.kind = EstimatorKind::kTriangulation;
  truth_ = {0.7, -0.9, 1.3, 0.02, radians(12.0), radians(-17.0)};
  Pose guess = truth_;
  guess.x -= 0.2;
  guess.y += 0.2;
  guess.yaw -= 0.1;
  const auto solution =
      estimatePose(map_, camera_, observe({0, 2, 5, 7}), prior(guess, 0.5, 0.3), config_);
  ASSERT_TRUE(solution);
  EXPECT_LT(error(solution->map_from_base.pose).norm(), 2e-6);
}

TEST_F(PoseEstimatorTest, ExactCornersGiveTheExactPose) {
  for (const EstimatorKind kind : {EstimatorKind::kTriangulation, EstimatorKind::kReprojection}) {
    config_.kind = kind;
    const auto solution = estimatePose(map_, camera_, observe({0, 2, 5, 7}),
                                       prior({0.5, -0.7, 1.2}, 0.5, 0.3), config_);
    ASSERT_TRUE(solution);
    EXPECT_LT(error(solution->map_from_base.pose).norm(), 2e-6);
    for (const Misfit& misfit : solution->misfits) EXPECT_LT(misfit.residual, 1e-3);
  }
}

TEST_F(PoseEstimatorTest, WithoutAPriorThreeMarkersAreEnough) {
  truth_.yaw = 0.5;
  const auto solution =
      estimatePose(map_, camera_, observe({1, 4, 8}), PosePrior::upright(), config_);
  ASSERT_TRUE(solution);
  EXPECT_LT(error(solution->map_from_base.pose).norm(), 1e-6);
}

TEST_F(PoseEstimatorTest, ConvergesFromFarOff) {
  const auto solution = estimatePose(map_, camera_, observe({0, 2, 5, 7}, 0.05),
                                     prior({1.3, -0.2, 1.0}, 1.0, 0.5), config_);
  ASSERT_TRUE(solution);
  EXPECT_LT(error(solution->map_from_base.pose).norm(), 3e-3);
  EXPECT_EQ(std::count(solution->used.begin(), solution->used.end(), true), 4);
}

TEST_F(PoseEstimatorTest, OneMarkersCornersNarrowThePriorDown) {
  // Seen from the front, a marker tells its distance and direction well, but hardly how far the
  // robot is around it: there the prior decides, as the covariance shows.
  const PosePrior start = prior({0.75, -0.85, 1.33}, 0.2, 0.1);
  const auto solution = estimatePose(map_, camera_, observe({3}), start, config_);
  ASSERT_TRUE(solution);
  const PoseEstimate& estimate = solution->map_from_base;
  const Eigen::Vector3d e = error(estimate.pose);
  EXPECT_LT(e.dot(floorCovariance(estimate).inverse() * e), 1.0);
  EXPECT_LT(solution->misfits[0].residual, 0.02);
  const double prior_determinant = 1.0 / start.information.topLeftCorner<3, 3>().determinant();
  EXPECT_LT(floorCovariance(estimate).determinant(), 1e-3 * prior_determinant);
}

TEST_F(PoseEstimatorTest, LeavesOutMarkersThatHangElsewhere) {
  for (const EstimatorKind kind : {EstimatorKind::kTriangulation, EstimatorKind::kReprojection}) {
    config_.kind = kind;
    std::vector<MarkerObservation> observations = observe({0, 1, 2, 3, 4, 5, 6, 7}, 0.05);
    for (const std::size_t moved : {2U, 6U}) {
      for (Eigen::Vector2d& corner : observations[moved].corners) corner += Eigen::Vector2d(9, -7);
      observations[moved].center += Eigen::Vector2d(9, -7);
    }
    const auto solution =
        estimatePose(map_, camera_, observations, prior({0.72, -0.88, 1.31}, 0.05, 0.03), config_);
    ASSERT_TRUE(solution);
    EXPECT_LT(error(solution->map_from_base.pose).head<2>().norm(), 4e-3);
    for (std::size_t i = 0; i < observations.size(); ++i) {
      EXPECT_EQ(solution->used[i], i != 2 && i != 6) << i;
    }
  }
}

TEST_F(PoseEstimatorTest, ACoveredEdgeDoesNotPullThePose) {
  std::vector<MarkerObservation> observations = observe({0, 2, 4, 7}, 0.02);
  observations[1].corners[1].x() += 1.2;
  observations[1].corners[2].x() += 0.8;
  const auto solution =
      estimatePose(map_, camera_, observations, prior({0.72, -0.88, 1.31}, 0.1, 0.05), config_);
  ASSERT_TRUE(solution);
  EXPECT_LT(error(solution->map_from_base.pose).head<2>().norm(), 2e-3);
}

TEST_F(PoseEstimatorTest, CovarianceMatchesTheSpreadOfManyTrials) {
  const double noise = 0.06;
  config_.reprojection.corner_noise = noise;
  // So wide that the estimate is plain least squares.
  config_.reprojection.robust_misfit = 1000.0;
  const PosePrior wide = prior(truth_, 1.0, 1.0);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d mean_covariance = Eigen::Matrix3d::Zero();
  constexpr int kTrials = 500;
  for (int i = 0; i < kTrials; ++i) {
    const auto solution = estimatePose(map_, camera_, observe({0, 3, 4}, noise), wide, config_);
    ASSERT_TRUE(solution);
    const Eigen::Vector3d e = error(solution->map_from_base.pose);
    spread += e * e.transpose() / kTrials;
    mean_covariance += floorCovariance(solution->map_from_base) / kTrials;
  }
  // The covariance is at least that of the noise, and larger in frames with larger residuals.
  const double ratio = (spread.inverse() * mean_covariance).trace() / 3.0;
  EXPECT_GT(ratio, 0.9);
  EXPECT_LT(ratio, 1.35);
}

TEST_F(PoseEstimatorTest, NoObservationsGiveNoPose) {
  EXPECT_FALSE(estimatePose(map_, camera_, {}, prior(truth_, 0.1, 0.1), config_));
}

TEST_F(PoseEstimatorTest, TwoMarkersAreTooFewToTriangulateButNotToNarrowThePrior) {
  config_.kind = EstimatorKind::kTriangulation;
  EXPECT_FALSE(estimatePose(map_, camera_, observe({0, 5}), PosePrior::upright(), config_));
  const auto solution =
      estimatePose(map_, camera_, observe({0, 5}), prior({0.75, -0.85, 1.33}, 0.1, 0.1), config_);
  ASSERT_TRUE(solution);
  EXPECT_LT(error(solution->map_from_base.pose).norm(), 0.01);
}

TEST_F(PoseEstimatorTest, NeighboursThatWereMovedAsOneDoNotDrawThePose) {
  const std::vector<std::size_t> seen = {0, 1, 2, 4, 5, 7, 8};
  for (std::size_t first = 0; first < seen.size(); ++first) {
    for (const double azimuth : {0.0, 0.5 * kPi, kPi, 1.5 * kPi}) {
      SCOPED_TRACE(std::to_string(first) + " " + std::to_string(azimuth));
      constexpr double kWay = 0.12;
      const MarkerMap map = map_;
      std::vector<std::size_t> moved;
      for (std::size_t k = 0; k < 3; ++k) moved.push_back(seen[(first + k) % seen.size()]);
      for (const std::size_t entry : moved) {
        map_.markers[entry].map_from_marker.pretranslate(
            kWay * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0));
      }
      const std::vector<MarkerObservation> observations = observe(seen, 0.03);
      map_ = map;
      const auto solution =
          estimatePose(map_, camera_, observations, prior({0.75, -0.95, 1.32}, 0.1, 0.05), config_);
      ASSERT_TRUE(solution);
      const Eigen::Vector3d off = error(solution->map_from_base.pose);
      // A moved marker that seems nearly in its place may still pull a little.
      EXPECT_LT(off.head<2>().norm(), 0.15 * kWay);
      EXPECT_LT(std::abs(off.z()), 0.15 * kWay / 4.0);
    }
  }
}

}  // namespace
}  // namespace omnitag
