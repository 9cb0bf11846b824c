#include "localization/marker_in_camera.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"

namespace omnitag {
namespace {

MarkerDetection detectionOf(const MarkerReading& reading) {
  MarkerDetection detection;
  detection.family = reading.family;
  detection.id = reading.id;
  detection.corners = reading.corners;
  detection.center = reading.center;
  return detection;
}

class MarkerInCameraTest : public testing::Test {
 protected:
  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
  Pose map_from_base_{0.3, -0.2, 0.5};
  EstimatorConfig config_;

  Eigen::Isometry3d truthOf(const Marker& marker) const {
    return (map_from_base_.toIsometry() * mounting_).inverse() * marker.map_from_marker;
  }
};

TEST_F(MarkerInCameraTest, IsWhereTheMarkerHangsSeenFromTheCamera) {
  int seen = 0;
  for (const Marker& marker : test::roomMarkers()) {
    const auto reading = test::exactReading(marker, {camera_, mounting_}, map_from_base_);
    if (!reading) continue;
    ++seen;
    const auto place =
        markerInCamera(camera_, detectionOf(*reading), marker.size, truthOf(marker), config_);
    ASSERT_TRUE(place) << marker.id;
    const Eigen::Isometry3d found = place->pose.toIsometry();
    EXPECT_LT((found.translation() - truthOf(marker).translation()).norm(), 1e-3) << marker.id;
    EXPECT_TRUE(found.linear().isApprox(truthOf(marker).linear(), 1e-3)) << marker.id;
  }
  EXPECT_GE(seen, 6);
}

TEST_F(MarkerInCameraTest, HasACovarianceThatIsTrue) {
  const Marker marker = test::roomMarkers().front();
  const auto exact = test::exactReading(marker, {camera_, mounting_}, map_from_base_);
  ASSERT_TRUE(exact);
  const Pose truth = Pose::fromIsometry(truthOf(marker));
  std::mt19937 random(4);
  constexpr int kTimes = 300;
  double nees = 0.0;
  for (int i = 0; i < kTimes; ++i) {
    const MarkerReading reading =
        test::withNoise(*exact, config_.reprojection.corner_noise, &random);
    const auto place =
        markerInCamera(camera_, detectionOf(reading), marker.size, truthOf(marker), config_);
    ASSERT_TRUE(place);
    const PoseVector error = difference(truth, place->pose);
    nees += error.dot(place->covariance.ldlt().solve(error)) / kTimes;
  }
  // The mean of 300 chi-squares with 6 degrees of freedom; the solver adds a little for what it
  // cannot determine.
  EXPECT_GT(nees, 4.0);
  EXPECT_LT(nees, 6.7);
}

TEST_F(MarkerInCameraTest, KnowsHowLargeAMarkerIs) {
  MarkerMap map{"map", test::roomMarkers()};
  map.default_size = 0.2;
  MarkerDetection detection;
  detection.family = "tag36h11";
  detection.id = 3;
  EXPECT_EQ(sizeOf(detection, map), 0.8);
  detection.id = 300;
  EXPECT_EQ(sizeOf(detection, map), 0.2);
  map.markers[5].size = 0.5;
  detection.map_entry = 5;
  EXPECT_EQ(sizeOf(detection, map), 0.5);
}

}  // namespace
}  // namespace omnitag
