#include "omnitag/camera/mounted_camera.h"

#include <gtest/gtest.h>

#include "../support/sample_cameras.h"

namespace omnitag {
namespace {

class MountedCameraTest : public testing::TestWithParam<Eigen::Isometry3d> {
 protected:
  MountedCamera camera_{test::sphericalCamera(), GetParam()};
  Pose2 pose_{1.3, -0.7, 2.1};
};

TEST_P(MountedCameraTest, SeesAPointOfTheMapWhereItsLineOfSightGoes) {
  int seen = 0;
  for (double azimuth = 0.0; azimuth < 6.2; azimuth += 0.7) {
    const Eigen::Vector3d point(pose_.x + 3.0 * std::cos(azimuth),
                                pose_.y + 3.0 * std::sin(azimuth), 1.4);
    const auto pixel = camera_.pixelFromMap(pose_, point);
    if (!pixel) continue;
    ++seen;
    const Ray ray = *camera_.rayInBase(*pixel);
    const Eigen::Vector3d in_base = pose_.toIsometry().inverse() * point;
    EXPECT_LT((in_base - ray.origin).cross(ray.direction).norm(), 1e-9);
    EXPECT_GT((in_base - ray.origin).dot(ray.direction), 0.0);
  }
  EXPECT_EQ(seen, 9);
}

TEST_P(MountedCameraTest, DerivativeByThePose) {
  const Eigen::Vector3d point(-1.0, 1.5, 1.2);
  Eigen::Matrix<double, 2, 3> by_pose;
  ASSERT_TRUE(camera_.pixelFromMap(pose_, point, &by_pose));
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    step(i) = kStep;
    const auto moved = [&](double sign) {
      return *camera_.pixelFromMap(
          {pose_.x + sign * step.x(), pose_.y + sign * step.y(), pose_.yaw + sign * step.z()},
          point);
    };
    const Eigen::Vector2d numeric = (moved(1.0) - moved(-1.0)) / (2.0 * kStep);
    EXPECT_LT((by_pose.col(i) - numeric).norm(), 1e-5 * by_pose.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(Mountings, MountedCameraTest,
                         testing::Values(test::lookingDown(), test::lookingUp()),
                         [](const auto& test) { return test.index == 0 ? "Down" : "Up"; });

TEST(MountedCameraAxisTest, KnowsWhichWayItLooks) {
  EXPECT_FALSE(MountedCamera(test::sphericalCamera(), test::lookingDown()).axisUp());
  EXPECT_TRUE(MountedCamera(test::sphericalCamera(), test::lookingUp()).axisUp());
}

}  // namespace
}  // namespace omnitag
