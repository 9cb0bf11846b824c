#include "omnitag/camera/mounted_camera.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "../support/sample_cameras.h"
#include "omnitag/camera/catadioptric_camera.h"

namespace omnitag {
namespace {

class MountedCameraTest : public testing::TestWithParam<Eigen::Isometry3d> {
 protected:
  MountedCamera camera_{test::sphericalCamera(), GetParam()};
  Pose pose_{1.3, -0.7, 2.1};
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
  for (const Pose& pose : {pose_, Pose{pose_.x, pose_.y, pose_.yaw, 0.1, -0.2, 0.3}}) {
    FrameJacobian by_frame;
    ASSERT_TRUE(camera_.pixelFromMap(pose, point, &by_frame));
    constexpr double kStep = 1e-6;
    for (int i = 0; i < 6; ++i) {
      const auto seenFrom = [&](double sign) {
        return *camera_.pixelFromMap(moved(pose, sign * kStep * PoseVector::Unit(i)), point);
      };
      const Eigen::Vector2d numeric = (seenFrom(1.0) - seenFrom(-1.0)) / (2.0 * kStep);
      EXPECT_LT((by_frame.col(i) - numeric).norm(), 1e-5 * by_frame.norm()) << i;
    }
  }
}

TEST_P(MountedCameraTest, AnErrorDisplacesWhatIsSeenAndTheLinesOfSight) {
  auto model = std::make_shared<CatadioptricCamera>(
      dynamic_cast<const CatadioptricCamera&>(camera_.model()));
  model->setUncertainty({0.7, 1.5, 0.9, 2.0});
  const MountedCamera camera(model, GetParam());
  const Eigen::Vector3d point(-1.0, 1.5, 1.2);
  FrameJacobian by_frame;
  const auto pixel = camera.pixelFromMap(pose_, point, &by_frame);
  ASSERT_TRUE(pixel);
  // The modes as they are defined, by hand.
  const Eigen::Vector2d center = model->imagePlane().principalPoint();
  const Eigen::Vector2d n = (*pixel - center) / (model->imagePlane().scale() * model->maxRadius());
  const std::array<Eigen::Vector2d, 6> modes = {
      Eigen::Vector2d(0.7, 0.0), Eigen::Vector2d(0.0, 0.7),        1.5 * n,
      0.9 * n.x() * n,           Eigen::Vector2d(0.9 * n.y() * n), 2.0 * n.squaredNorm() * n};
  for (int i = 0; i < 6; ++i) {
    const CameraError error = 1.3 * CameraError::Unit(i);
    const Eigen::Vector2d& mode = modes[static_cast<std::size_t>(i)];
    EXPECT_LT((by_frame.col(6 + i) - mode).norm(), 1e-12) << i;
    const MountedCamera off = camera.withError(error);
    const auto displaced = off.pixelFromMap(pose_, point);
    ASSERT_TRUE(displaced);
    EXPECT_LT((*displaced - *pixel - 1.3 * mode).norm(), 1e-12) << i;
    // What is seen there lies on its line of sight.
    const auto ray = off.rayInBase(*displaced);
    ASSERT_TRUE(ray);
    const Eigen::Vector3d in_base = pose_.toIsometry().inverse() * point;
    const auto back = model->pixelFromPoint(camera.baseFromCamera().inverse() * in_base);
    EXPECT_LT((in_base - ray->origin).cross(ray->direction).norm(), 1e-4) << i;
    EXPECT_LT((*back - *pixel).norm(), 1e-12);
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
