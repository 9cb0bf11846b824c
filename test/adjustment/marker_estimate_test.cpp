#include "adjustment/marker_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"

namespace omnitag {
namespace {

/// rad, between the orientations of two markers.
double turnBetween(const Marker& a, const Marker& b) {
  return Eigen::AngleAxisd(a.map_from_marker.linear().transpose() * b.map_from_marker.linear())
      .angle();
}

class MarkerEstimateTest : public testing::Test {
 protected:
  /// Sightings from places along a line past the marker; `noise` in pixels.
  std::vector<MarkerSighting> sightings(const Marker& marker, int count, double step,
                                        double noise) {
    std::vector<MarkerSighting> result;
    for (int i = 0; i < count; ++i) {
      const Pose pose{-0.5 * step * (count - 1) + step * i, 0.1 * std::sin(1.0 * i), 0.3 * i};
      const auto reading = test::exactReading(marker, {camera_, mounting_}, pose);
      if (!reading) continue;
      result.push_back({1.0 * i,
                        mounting_,
                        {pose, 1e-8 * PoseMatrix::Identity()},
                        test::withNoise(*reading, noise, &random_).corners});
    }
    return result;
  }

  /// What is known of a marker beforehand: its id and size.
  static Marker unknown(const Marker& marker) {
    Marker result = marker;
    result.map_from_marker.setIdentity();
    return result;
  }

  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
  std::mt19937 random_{1};
};

TEST_F(MarkerEstimateTest, ExactReadingsGiveTheExactPlace) {
  for (const Marker& marker : {test::wallMarker(1, {0.4, 2.2, 1.4}, -1.8, 0.6),
                               test::wallMarker(2, {-0.3, -2.0, 0.9}, 1.2),
                               test::lyingMarker(3, {0.5, 1.8, 0.0}, true, 0.7, 0.8)}) {
    const auto seen = sightings(marker, 6, 0.3, 0.0);
    ASSERT_GE(seen.size(), 4U) << marker.id;
    const auto estimate = estimateMarker(unknown(marker), {camera_}, seen, std::nullopt, {});
    ASSERT_TRUE(estimate) << marker.id;
    EXPECT_LT((estimate->marker.center() - marker.center()).norm(), 1e-5) << marker.id;
    EXPECT_LT(turnBetween(estimate->marker, marker), 1e-5) << marker.id;
    EXPECT_GT(estimate->lead, 5.0);
  }
}

TEST_F(MarkerEstimateTest, OneSightingIsAmbiguousOrRight) {
  const Marker marker = test::wallMarker(1, {0.2, 2.0, 1.3}, -1.2);
  const auto seen = sightings(marker, 1, 0.3, 0.0);
  ASSERT_EQ(seen.size(), 1U);
  const std::vector<Marker> places =
      markersFromSighting(unknown(marker), {camera_}, seen.front(), 1.0);
  ASSERT_FALSE(places.empty());
  EXPECT_LT(turnBetween(places.front(), marker), 1e-4);
  EXPECT_LT((places.front().center() - marker.center()).norm(), 1e-4);
}

TEST_F(MarkerEstimateTest, CovarianceIsThatOfTheErrors) {
  const Marker marker = test::wallMarker(1, {0.3, 2.3, 1.4}, -1.7, 0.1);
  constexpr int kRuns = 150;
  constexpr double kNoise = 0.1;
  double sum = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    const auto seen = sightings(marker, 8, 0.25, kNoise);
    MarkerEstimateConfig config;
    config.corner_noise = kNoise;
    const auto estimate = estimateMarker(unknown(marker), {camera_}, seen, marker, config);
    ASSERT_TRUE(estimate);
    MarkerIncrement error;
    error.head<3>() = estimate->marker.center() - marker.center();
    const Eigen::AngleAxisd turn(estimate->marker.map_from_marker.linear() *
                                 marker.map_from_marker.linear().transpose());
    error.tail<3>() = turn.angle() * turn.axis();
    sum += error.dot(estimate->covariance.ldlt().solve(error));
  }
  // Chi-square with 6 degrees of freedom: the mean of so many is 6 +- 0.28 if the covariance is
  // true; robust weights and a variance factor of at least 1 reduce it a little.
  EXPECT_NEAR(sum / kRuns, 6.0, 1.1);
}

TEST_F(MarkerEstimateTest, UncertainPosesMakeItUncertain) {
  const Marker marker = test::wallMarker(1, {0.3, 2.3, 1.4}, -1.7);
  std::vector<MarkerSighting> seen = sightings(marker, 8, 0.25, 0.05);
  const auto exact = estimateMarker(unknown(marker), {camera_}, seen, std::nullopt, {});
  for (MarkerSighting& sighting : seen) {
    sighting.map_from_base.covariance = 1e-4 * PoseMatrix::Identity();
  }
  const auto vague = estimateMarker(unknown(marker), {camera_}, seen, std::nullopt, {});
  ASSERT_TRUE(exact && vague);
  // Eight positions that are off by 1 cm each, whatever their headings.
  EXPECT_GT(vague->positionDeviation(), 0.01 / std::sqrt(8.0));
  EXPECT_LT(exact->positionDeviation(), 0.3 * vague->positionDeviation());
}

TEST_F(MarkerEstimateTest, MotionTellsTheSize) {
  const Marker marker = test::wallMarker(1, {0.3, 2.3, 1.4}, -1.7);
  Marker guess = unknown(marker);
  guess.size = 0.6;
  MarkerEstimateConfig config;
  config.estimates_size = true;
  const auto estimate =
      estimateMarker(guess, {camera_}, sightings(marker, 8, 0.25, 0.0), std::nullopt, config);
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->marker.size, marker.size, 1e-4);
  EXPECT_GT(estimate->size_variance, 0.0);
  // From one place, it cannot be determined.
  EXPECT_FALSE(
      estimateMarker(guess, {camera_}, sightings(marker, 1, 0.25, 0.0), std::nullopt, config) &&
      estimateMarker(guess, {camera_}, sightings(marker, 1, 0.25, 0.0), std::nullopt, config)
              ->size_variance < 0.01);
}

TEST_F(MarkerEstimateTest, ReadingsOfAnotherPlaceDoNotMoveIt) {
  const Marker marker = test::wallMarker(1, {0.3, 2.3, 1.4}, -1.7);
  std::vector<MarkerSighting> seen = sightings(marker, 9, 0.25, 0.05);
  const Marker elsewhere = test::wallMarker(1, {0.9, 2.3, 1.2}, -1.4);
  seen[2].corners = sightings(elsewhere, 9, 0.25, 0.05)[2].corners;
  const auto estimate = estimateMarker(unknown(marker), {camera_}, seen, std::nullopt, {});
  ASSERT_TRUE(estimate);
  EXPECT_LT((estimate->marker.center() - marker.center()).norm(), 0.01);
  EXPECT_FALSE(estimate->agrees[2]);
}

}  // namespace
}  // namespace omnitag
