#include "adjustment/marker_projection.h"

#include <gtest/gtest.h>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"

namespace omnitag {
namespace {

constexpr double kStep = 1e-6;

class MarkerProjectionTest : public testing::Test {
 protected:
  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
  Pose pose_{0.4, -0.3, 0.8};
  Marker marker_ = test::wallMarker(3, {-1.6, 1.4, 1.3}, -0.9, 0.4);

  CornerPixels pixelsOf(const Marker& marker, const Pose& pose) const {
    return projectMarker(marker, camera_, pose)->pixels;
  }
};

TEST_F(MarkerProjectionTest, PixelsAreThoseOfTheCorners) {
  const auto reading = test::exactReading(marker_, camera_, pose_);
  ASSERT_TRUE(reading);
  const CornerPixels pixels = pixelsOf(marker_, pose_);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(pixels(2 * k), reading->corners[static_cast<std::size_t>(k)].x());
    EXPECT_EQ(pixels(2 * k + 1), reading->corners[static_cast<std::size_t>(k)].y());
  }
}

TEST_F(MarkerProjectionTest, DerivativesAreThoseOfDifferences) {
  const MarkerProjection projection = *projectMarker(marker_, camera_, pose_);
  for (int i = 0; i < 6; ++i) {
    const auto at = [&](double step) {
      MarkerIncrement increment = MarkerIncrement::Zero();
      increment(i) = step;
      Marker marker = marker_;
      marker.map_from_marker = moved(marker_.map_from_marker, increment);
      return pixelsOf(marker, pose_);
    };
    const CornerPixels numeric = (at(kStep) - at(-kStep)) / (2.0 * kStep);
    EXPECT_LT((projection.by_marker.col(i) - numeric).norm(), 1e-5 * projection.by_marker.norm())
        << i;
  }
  for (int i = 0; i < 6; ++i) {
    const auto at = [&](double step) {
      return pixelsOf(marker_, moved(pose_, step * PoseVector::Unit(i)));
    };
    const CornerPixels numeric = (at(kStep) - at(-kStep)) / (2.0 * kStep);
    EXPECT_LT((projection.by_pose.col(i) - numeric).norm(), 1e-5 * projection.by_pose.norm()) << i;
  }
  const auto at = [&](double step) {
    Marker marker = marker_;
    marker.size += step;
    return pixelsOf(marker, pose_);
  };
  const CornerPixels numeric = (at(kStep) - at(-kStep)) / (2.0 * kStep);
  EXPECT_LT((projection.by_size - numeric).norm(), 1e-5 * projection.by_size.norm());
}

TEST_F(MarkerProjectionTest, TurnsAboutItsCentreAlongTheMapsAxes) {
  MarkerIncrement increment;
  increment << 0.1, -0.2, 0.3, 0.0, 0.0, radians(90.0);
  const Eigen::Isometry3d after = moved(marker_.map_from_marker, increment);
  EXPECT_LT((after.translation() - marker_.center() - Eigen::Vector3d(0.1, -0.2, 0.3)).norm(),
            1e-12);
  const Eigen::Vector3d normal = marker_.normal();
  EXPECT_LT((after.linear().col(2) - Eigen::Vector3d(-normal.y(), normal.x(), normal.z())).norm(),
            1e-12);
}

TEST(RotationTest, LeftJacobianIsThatOfDifferences) {
  for (const Eigen::Vector3d& vector : {Eigen::Vector3d(0.3, -0.8, 0.5), Eigen::Vector3d(0, 0, 0),
                                        Eigen::Vector3d(1e-6, 2e-6, -1e-6)}) {
    const Eigen::Matrix3d jacobian = leftJacobian(vector);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
      const Eigen::AngleAxisd change(rotationOf(vector + step) *
                                     rotationOf(vector - step).transpose());
      const Eigen::Vector3d numeric = change.angle() * change.axis() / (2.0 * kStep);
      EXPECT_LT((jacobian.col(i) - numeric).norm(), 1e-6);
    }
  }
}

}  // namespace
}  // namespace omnitag
