#include "localization/marker_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"

namespace omnitag {
namespace {

constexpr double kMaxResidual = 1.5;

class MarkerPoseTest : public testing::TestWithParam<Eigen::Isometry3d> {
 protected:
  std::vector<ReprojectionFit> poses(const Marker& marker, const MarkerReading& reading) const {
    return posesFromMarker({"map", {marker}}, camera_, {0, reading.corners, reading.center},
                           PosePrior::upright(), {});
  }

  /// The pose of a robot whose camera is in this direction and at this distance from the marker's
  /// middle.
  Pose poseAt(const Marker& marker, double azimuth, double distance, double yaw) const {
    const Eigen::Vector2d camera = marker.center().head<2>() +
                                   distance * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
    const Eigen::Vector2d offset =
        Eigen::Rotation2Dd(yaw) * camera_.baseFromCamera().translation().head<2>();
    return {camera.x() - offset.x(), camera.y() - offset.y(), yaw};
  }

  MountedCamera camera_{test::sphericalCamera(), GetParam()};
};

TEST_P(MarkerPoseTest, ExactCornersGiveTheTruePose) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  int seen = 0;
  for (const double distance : {1.0, 2.0, 3.5, 6.0}) {
    for (const double incidence : {-70.0, -50.0, -30.0, -12.0, 0.0, 5.0, 20.0, 40.0, 60.0}) {
      for (const double roll : {0.0, 90.0, 200.0}) {
        const double facing = angle(generator);
        const Marker marker = test::wallMarker(1, {1.0, -2.0, 1.3}, facing, radians(roll));
        const Pose truth = poseAt(marker, facing + radians(incidence), distance, angle(generator));
        const auto reading = test::exactReading(marker, camera_, truth);
        if (!reading) continue;
        ++seen;
        double nearest = std::numeric_limits<double>::infinity();
        double heading_error = nearest;
        double last_residual = 0.0;
        for (const ReprojectionFit& fit : poses(marker, *reading)) {
          const Pose& pose = fit.map_from_base.pose;
          const double error = test::positionError(pose, truth);
          if (error < nearest) {
            nearest = error;
            heading_error = std::abs(normalizeAngle(pose.yaw - truth.yaw));
          }
          EXPECT_GE(fit.misfits[0].residual, last_residual) << "the best comes first";
          last_residual = fit.misfits[0].residual;
        }
        // Seen straight on, a marker looks the same from a little to the left and to the right:
        // the optimum is flat.
        EXPECT_LT(nearest, 2e-3) << distance << " m, " << incidence << " degrees, roll " << roll;
        EXPECT_LT(heading_error, 2e-3) << distance << " m, " << incidence << " degrees, " << roll;
      }
    }
  }
  EXPECT_GT(seen, 60);
}

TEST_P(MarkerPoseTest, EveryPoseShowsTheMarkerAsItWasObserved) {
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> incidence(radians(-70.0), radians(70.0));
  std::uniform_real_distribution<double> distance(1.5, 6.0);
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  for (int i = 0; i < 40; ++i) {
    const double facing = angle(generator);
    const Marker marker = test::wallMarker(1, {0.0, 0.0, 1.4}, facing, angle(generator));
    const Pose truth =
        poseAt(marker, facing + incidence(generator), distance(generator), angle(generator));
    const auto exact = test::exactReading(marker, camera_, truth);
    if (!exact) continue;
    const MarkerReading reading = test::withNoise(*exact, 0.1, &generator);
    for (const ReprojectionFit& fit : poses(marker, reading)) {
      const auto seen = test::exactReading(marker, camera_, fit.map_from_base.pose);
      if (!seen) continue;  // beyond the incidence at which it could be read
      double squares = 0.0;
      for (std::size_t k = 0; k < 4; ++k) {
        squares += (seen->corners[k] - reading.corners[k]).squaredNorm();
      }
      EXPECT_LE(std::sqrt(squares / 4.0), kMaxResidual);
      EXPECT_NEAR(std::sqrt(squares / 4.0), fit.misfits[0].residual, 1e-6);
    }
  }
}

TEST_P(MarkerPoseTest, TheTrueOptimumIsAmongThemWhereTwoAreCloseTogether) {
  // Seen nearly from the front and far away, a marker has one optimum on each side of its normal.
  std::mt19937 generator(6);
  std::uniform_real_distribution<double> incidence(radians(-25.0), radians(25.0));
  std::uniform_real_distribution<double> distance(4.0, 7.0);
  std::uniform_real_distribution<double> angle(-kPi, kPi);
  for (int i = 0; i < 600; ++i) {
    const double facing = angle(generator);
    const Marker marker = test::wallMarker(1, {0.0, 0.0, 1.0}, facing);
    const Pose truth =
        poseAt(marker, facing + incidence(generator), distance(generator), angle(generator));
    const auto exact = test::exactReading(marker, camera_, truth);
    ASSERT_TRUE(exact);
    const MarkerReading reading = test::withNoise(*exact, 0.05, &generator);
    const MarkerObservation observation{0, reading.corners, reading.center};
    const double at_truth =
        misfitsAt({"map", {marker}}, camera_, {observation}, truth, ImagingError::Zero(), {})[0]
            .residual;
    const std::vector<ReprojectionFit> fits = poses(marker, reading);
    ASSERT_FALSE(fits.empty());
    // An optimum cannot be worse than the truth, except through the robust weights.
    EXPECT_LT(fits.front().misfits[0].residual, at_truth + 0.01)
        << "trial " << i << ", off by "
        << test::positionError(fits.front().map_from_base.pose, truth);
  }
}

TEST_P(MarkerPoseTest, AMarkerSeenFromBehindHasNone) {
  const Marker marker = test::wallMarker(1, {0.0, 0.0, 1.3}, 0.0);
  for (const double azimuth : {120.0, 150.0, 180.0, 230.0}) {
    for (const double distance : {1.5, 3.0, 5.0}) {
      const Pose behind = poseAt(marker, radians(azimuth), distance, 0.4);
      MarkerReading reading;
      for (std::size_t k = 0; k < 4; ++k) {
        reading.corners[k] = *camera_.pixelFromMap(behind, marker.corners()[k]);
      }
      reading.center = *camera_.pixelFromMap(behind, marker.center());
      EXPECT_TRUE(poses(marker, reading).empty()) << azimuth << " degrees, " << distance << " m";
    }
  }
}

TEST_P(MarkerPoseTest, AnImpossibleQuadrilateralHasNone) {
  const Marker marker = test::wallMarker(1, {0.0, 0.0, 1.3}, 0.0);
  const Pose truth = poseAt(marker, 0.5, 3.0, 0.4);
  MarkerReading reading = *test::exactReading(marker, camera_, truth);
  reading.corners[1] += Eigen::Vector2d(12.0, -9.0);
  EXPECT_TRUE(poses(marker, reading).empty());
  // Outside the field of the panorama.
  reading.center = {2.0, 2.0};
  EXPECT_TRUE(poses(marker, reading).empty());
}

TEST_P(MarkerPoseTest, AMirroredPoseStandsAndLeansAlike) {
  const Marker marker = test::wallMarker(1, {1.0, -2.0, 1.3}, 0.6);
  Pose pose = poseAt(marker, 0.6 + radians(25.0), 3.0, 2.0);
  pose.z = 0.02;
  pose.roll = radians(9.0);
  pose.pitch = radians(-14.0);
  const auto mirrored = mirroredPose(marker, camera_, pose);
  ASSERT_TRUE(mirrored);
  EXPECT_EQ(mirrored->z, pose.z);
  EXPECT_EQ(mirrored->roll, pose.roll);
  EXPECT_EQ(mirrored->pitch, pose.pitch);
  const auto again = mirroredPose(marker, camera_, *mirrored);
  ASSERT_TRUE(again);
  EXPECT_LT(difference(*again, pose).norm(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Mountings, MarkerPoseTest,
                         testing::Values(test::lookingDown(), test::lookingUp()),
                         [](const auto& test) { return test.index == 0 ? "Down" : "Up"; });

}  // namespace
}  // namespace omnitag
