#include "measurement/marker_misplacement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "camera/catadioptric_camera.h"
#include "camera/mounted_camera.h"

namespace omnitag {
namespace {

/// Numerical derivative of the corners' pixels with respect to the marker's place (along and about
/// the map's axes).
Eigen::Matrix<double, 8, 6> byPlace(const Marker& marker, const MountedCamera& camera,
                                    const Pose& pose) {
  constexpr double kStep = 1e-6;
  const auto pixels = [&](int i, double step) {
    Marker other = marker;
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(i % 3);
    if (i < 3) {
      other.map_from_marker.pretranslate(step * unit);
    } else {
      other.map_from_marker.linear() =
          Eigen::AngleAxisd(step, unit).toRotationMatrix() * marker.map_from_marker.linear();
    }
    Eigen::Matrix<double, 8, 1> stacked;
    const Corners<Eigen::Vector3d> corners = other.corners();
    for (int k = 0; k < 4; ++k) {
      stacked.segment<2>(2 * k) = *camera.pixelFromMap(pose, corners[static_cast<std::size_t>(k)]);
    }
    return stacked;
  };
  Eigen::Matrix<double, 8, 6> derivative;
  for (int i = 0; i < 6; ++i) {
    derivative.col(i) = (pixels(i, kStep) - pixels(i, -kStep)) / (2.0 * kStep);
  }
  return derivative;
}

TEST(MarkerMisplacementTest, IsWhatAMarkerElsewhereDoesToItsCorners) {
  const MountedCamera camera(test::sphericalCamera(), test::lookingDown());
  constexpr double kDeviation = 0.02;
  constexpr double kOrientationDeviation = 0.03;
  const Marker marker = test::wallMarker(6, {2.5, 0.9, 1.3}, kPi + 0.2, 0.4);
  for (const Pose& pose : {Pose{0.4, -0.3, 2.1}, Pose{0.4, -0.3, 2.1, 0.05, -0.1, 0.15}}) {
    Eigen::Matrix<double, 8, 6> by_pose;
    const Corners<Eigen::Vector3d> corners = marker.corners();
    for (int k = 0; k < 4; ++k) {
      FrameJacobian by_frame;
      ASSERT_TRUE(camera.pixelFromMap(pose, corners[static_cast<std::size_t>(k)], &by_frame));
      by_pose.middleRows<2>(2 * k) = by_frame.leftCols<6>();
    }
    Eigen::Matrix<double, 6, 1> deviations;
    deviations << Eigen::Vector3d::Constant(kDeviation),
        Eigen::Vector3d::Constant(kOrientationDeviation);
    const Eigen::Matrix<double, 8, 6> by_place =
        byPlace(marker, camera, pose) * deviations.asDiagonal();
    const Eigen::Matrix<double, 8, 8> expected = by_place * by_place.transpose();
    const Eigen::Matrix<double, 8, 8> found =
        by_pose * seenFrom(pose, marker, {kDeviation, kOrientationDeviation}) * by_pose.transpose();
    EXPECT_LT((found - expected).norm(), 1e-5 * expected.norm());
  }
}

TEST(MarkerMisplacementTest, AnUncertainCameraDisplacesEachMarkerALittle) {
  auto model = std::make_shared<CatadioptricCamera>(
      dynamic_cast<const CatadioptricCamera&>(*test::sphericalCamera()));
  Marker marker = test::wallMarker(6, {2.5, 0.9, 1.3}, kPi);
  constexpr double kPixelsPerMetre = 50.0;
  EXPECT_TRUE(misplacementOf(marker, *model, kPixelsPerMetre, 0.0).isNone());
  marker.deviation = 0.01;
  marker.orientation_deviation = 0.02;
  const Misplacement of_map = misplacementOf(marker, *model, kPixelsPerMetre, 0.0);
  EXPECT_EQ(of_map.position, 0.01);
  EXPECT_EQ(of_map.orientation, 0.02);
  model->setUncertainty({1.0, 0.5, 0.0, 0.2});
  const Misplacement both = misplacementOf(marker, *model, kPixelsPerMetre, 0.0);
  EXPECT_NEAR(both.position, std::hypot(0.01, 0.3 / kPixelsPerMetre), 1e-12);
  EXPECT_NEAR(both.orientation, std::hypot(0.02, 0.3 / kPixelsPerMetre / marker.size), 1e-12);
}

}  // namespace
}  // namespace omnitag
