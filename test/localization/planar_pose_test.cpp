#include "localization/planar_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "localization/marker_pose.h"

namespace omnitag {
namespace {

struct Setup {
  std::shared_ptr<const CameraModel> camera;
  Eigen::Isometry3d base_from_camera;
};

/// Robots at any height, with any heading and leaning by up to 30 degrees, in front of a marker.
class PlanarPoseTest : public testing::TestWithParam<Setup> {
 protected:
  Pose randomPose() {
    const double lean = radians(30.0);
    return {2.0 * uniform(), 2.0 * uniform(),  kPi * uniform(),
            uniform(),       lean * uniform(), lean * uniform()};
  }

  /// Between -1 and 1.
  double uniform() { return uniform_(generator_); }

  /// m: distance from the camera at a true pose to the marker.
  double range(const Marker& marker, const Pose& truth) const {
    return (camera_.mapFromCamera(truth).translation() - marker.center()).norm();
  }

  static double apart(const Pose& a, const Pose& b) {
    const PoseVector difference = omnitag::difference(a, b);
    return std::max(translationPart(difference).norm(), rotationPart(difference).norm());
  }

  MountedCamera camera_{GetParam().camera, GetParam().base_from_camera};
  std::mt19937 generator_{8};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

TEST_P(PlanarPoseTest, IsNearTheTruthForExactCorners) {
  int seen = 0;
  for (int i = 0; i < 400; ++i) {
    const Marker marker = test::wallMarker(1, {0.0, 3.0, 1.3}, -kPi / 2, kPi * uniform());
    const Pose truth = randomPose();
    const auto reading = test::exactReading(marker, camera_, truth);
    if (!reading || range(marker, truth) < 1.5) continue;
    ++seen;
    const auto poses = planarPoses(marker, camera_, {0, reading->corners, reading->center});
    double nearest = std::numeric_limits<double>::infinity();
    for (const Pose& pose : poses) nearest = std::min(nearest, apart(pose, truth));
    // Lines of sight that do not meet in one point leave an error for a later iteration to remove.
    EXPECT_LT(nearest, 0.08) << i;
  }
  EXPECT_GT(seen, 100);
}

TEST_P(PlanarPoseTest, AFlippedPoseShowsAFarMarkerAlmostAlike) {
  int seen = 0;
  for (int i = 0; i < 400; ++i) {
    Marker marker = test::wallMarker(1, {0.0, 5.0, 1.3}, -kPi / 2);
    marker.size = 0.2;
    const Pose truth = randomPose();
    const auto reading = test::exactReading(marker, camera_, truth);
    if (!reading) continue;
    const Pose flipped = flippedPose(marker, camera_, truth);
    EXPECT_LT(apart(flippedPose(marker, camera_, flipped), truth), 1e-9) << "twice is not at all";
    const double edge = meanEdge(reading->corners);
    const Corners<Eigen::Vector3d> corners = marker.corners();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const auto pixel = camera_.pixelFromMap(flipped, corners[k]);
      if (!pixel) continue;
      ++seen;
      EXPECT_LT((*pixel - reading->corners[k]).norm(), 0.06 * edge) << i;
    }
  }
  EXPECT_GT(seen, 100);
}

TEST_P(PlanarPoseTest, LeadsToTheTruthWhereNothingIsKnownOfHowTheRobotStands) {
  int seen = 0;
  for (int i = 0; i < 100; ++i) {
    const Marker marker = test::wallMarker(1, {0.0, 3.0, 1.3}, -kPi / 2, kPi * uniform());
    const Pose truth = randomPose();
    const auto reading = test::exactReading(marker, camera_, truth);
    if (!reading || range(marker, truth) < 1.0) continue;
    ++seen;
    double nearest = std::numeric_limits<double>::infinity();
    for (const ReprojectionFit& fit :
         posesFromMarker({"map", {marker}}, camera_, {0, reading->corners, reading->center},
                         PosePrior{}, EstimatorConfig{})) {
      nearest = std::min(nearest, apart(fit.map_from_base.pose, truth));
    }
    EXPECT_LT(nearest, 5e-3) << i;
  }
  EXPECT_GT(seen, 25);
}

INSTANTIATE_TEST_SUITE_P(Cameras, PlanarPoseTest,
                         testing::Values(Setup{test::sphericalCamera(), test::lookingDown()},
                                         Setup{test::hyperbolicCamera(), test::lookingUp()},
                                         Setup{test::equidistantCamera(), test::lookingUp()}));

}  // namespace
}  // namespace omnitag
