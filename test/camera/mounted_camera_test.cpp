#include "camera/mounted_camera.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "../support/sample_cameras.h"
#include "camera/catadioptric_camera.h"

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
    const ImagingError error = 1.3 * ImagingError::Unit(i);
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

class MovingCameraTest : public MountedCameraTest {
 protected:
  MovingCameraTest() {
    shutter_.image_time_offset = 0.004;
    shutter_.row_readout_time = 6e-5;
    motion_.velocity << 0.9, -0.3, 1.4, 0.05, 0.1, -0.2;
    motion_.deviations = {0.1, 0.2, 0.3};
  }

  MountedCamera moving() const { return camera_.withMotion(shutter_, motion_); }

  ShutterConfig shutter_;
  BaseMotion motion_;
  Eigen::Vector3d point_{-1.0, 1.5, 1.2};
};

TEST_P(MovingCameraTest, SeesAPointWhereItIsWhenItsRowIsExposed) {
  const auto pixel = moving().pixelFromMap(pose_, point_);
  ASSERT_TRUE(pixel);
  // A resting camera where the moving one is by then, integrated in many small steps.
  const double time = 0.004 + 6e-5 * pixel->y();
  constexpr int kSteps = 10000;
  Eigen::Isometry3d then = pose_.toIsometry();
  for (int i = 0; i < kSteps; ++i) {
    const PoseVector step = time / kSteps * motion_.velocity;
    const Eigen::Vector3d turn(step[4], step[5], step[2]);
    then.translate(Eigen::Vector3d(step[0], step[1], step[3]));
    then.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  }
  const auto expected = camera_.pixelFromMap(then, point_);
  ASSERT_TRUE(expected);
  EXPECT_LT((*pixel - *expected).norm(), 1e-3);
  EXPECT_GT((*pixel - *camera_.pixelFromMap(pose_, point_)).norm(), 0.5);
  // Its line of sight is that of base_link at the stamp.
  const Eigen::Vector3d in_base = pose_.toIsometry().inverse() * point_;
  const auto ray = moving().rayInBase(*pixel);
  ASSERT_TRUE(ray);
  EXPECT_LT((in_base - ray->origin).cross(ray->direction).norm(), 1e-4);
}

TEST_P(MovingCameraTest, Derivatives) {
  FrameJacobian by_frame;
  Eigen::Matrix<double, 2, 3> by_point;
  ASSERT_TRUE(moving().pixelFromMap(pose_, point_, &by_frame, &by_point));
  constexpr double kStep = 1e-4;
  for (int i = 0; i < 6; ++i) {
    const auto seenFrom = [&](double sign) {
      return *moving().pixelFromMap(moved(pose_, sign * kStep * PoseVector::Unit(i)), point_);
    };
    const Eigen::Vector2d numeric = (seenFrom(1.0) - seenFrom(-1.0)) / (2.0 * kStep);
    EXPECT_LT((by_frame.col(i) - numeric).norm(), 1e-3 * by_frame.leftCols<6>().norm()) << i;
  }
  for (int i = 0; i < 3; ++i) {
    const int column = kFrameUnknowns - 3 + i;
    const auto withVelocity = [&](double sign) {
      ImagingError error = ImagingError::Zero();
      error[kImagingUnknowns - 3 + i] = sign;
      return *moving().withError(error).pixelFromMap(pose_, point_);
    };
    const Eigen::Vector2d numeric = 0.5 * (withVelocity(1.0) - withVelocity(-1.0));
    EXPECT_GT(numeric.norm(), 0.01) << i;
    EXPECT_LT((by_frame.col(column) - numeric).norm(), 0.02 * numeric.norm()) << i;
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
    const Eigen::Vector2d along =
        *moving().pixelFromMap(pose_, point_ + step) - *moving().pixelFromMap(pose_, point_ - step);
    EXPECT_LT((by_point.col(i) - along / (2.0 * kStep)).norm(), 1e-3 * by_point.norm()) << i;
  }
}

TEST(BaseMotionTest, AVelocityLeadsToTheMotionThatItIsOf) {
  BaseMotion motion;
  motion.velocity << 0.9, -0.3, 1.4, 0.05, 0.1, -0.2;
  const PoseVector again = velocityOf(motion.after(0.04), 0.04);
  EXPECT_LT((again - motion.velocity).norm(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Mountings, MovingCameraTest,
                         testing::Values(test::lookingDown(), test::lookingUp()),
                         [](const auto& test) { return test.index == 0 ? "Down" : "Up"; });
INSTANTIATE_TEST_SUITE_P(Mountings, MountedCameraTest,
                         testing::Values(test::lookingDown(), test::lookingUp()),
                         [](const auto& test) { return test.index == 0 ? "Down" : "Up"; });

TEST(MountedCameraAxisTest, KnowsWhichWayItLooks) {
  EXPECT_FALSE(MountedCamera(test::sphericalCamera(), test::lookingDown()).axisUp());
  EXPECT_TRUE(MountedCamera(test::sphericalCamera(), test::lookingUp()).axisUp());
}

}  // namespace
}  // namespace omnitag
