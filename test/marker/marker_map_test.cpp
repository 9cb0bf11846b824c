#include "omnitag/marker/marker_map.h"

#include <gtest/gtest.h>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

using Eigen::Vector3d;

constexpr double kTolerance = 1e-12;

Marker hang(const Vector3d& position, double yaw, double roll, double size) {
  Marker marker;
  marker.size = size;
  marker.map_from_marker = Eigen::Translation3d(position) * uprightOrientation(yaw, roll);
  return marker;
}

void expectAxes(const Eigen::Quaterniond& map_from_marker, const Vector3d& x, const Vector3d& y,
                const Vector3d& z) {
  EXPECT_LT((map_from_marker * Vector3d::UnitX() - x).norm(), kTolerance);
  EXPECT_LT((map_from_marker * Vector3d::UnitY() - y).norm(), kTolerance);
  EXPECT_LT((map_from_marker * Vector3d::UnitZ() - z).norm(), kTolerance);
}

// The marker on the wall x = 0 faces east; its viewer looks west, with north to the right.
TEST(UprightOrientation, AtYawZeroTheNormalIsTheMapsX) {
  expectAxes(uprightOrientation(0.0, 0.0), Vector3d::UnitY(), Vector3d::UnitZ(), Vector3d::UnitX());
}

TEST(UprightOrientation, YawIsTheHeadingOfTheNormal) {
  expectAxes(uprightOrientation(radians(90.0), 0.0), -Vector3d::UnitX(), Vector3d::UnitZ(),
             Vector3d::UnitY());
  expectAxes(uprightOrientation(radians(180.0), 0.0), -Vector3d::UnitY(), Vector3d::UnitZ(),
             -Vector3d::UnitX());
  const double yaw = -2.1;
  expectAxes(uprightOrientation(yaw, 0.0), Vector3d(-std::sin(yaw), std::cos(yaw), 0.0),
             Vector3d::UnitZ(), Vector3d(std::cos(yaw), std::sin(yaw), 0.0));
}

// Counter-clockwise by a quarter: what was on the right is on top, what was on top on the left.
TEST(UprightOrientation, RollIsCounterClockwiseForTheViewer) {
  expectAxes(uprightOrientation(0.0, radians(90.0)), Vector3d::UnitZ(), -Vector3d::UnitY(),
             Vector3d::UnitX());
}

TEST(Marker, CornersGoRoundFromTheLowerLeft) {
  const Corners<Vector3d> corners = hang({1.0, 2.0, 3.0}, 0.0, 0.0, 0.5).corners();
  EXPECT_LT((corners[0] - Vector3d(1.0, 1.75, 2.75)).norm(), kTolerance);
  EXPECT_LT((corners[1] - Vector3d(1.0, 2.25, 2.75)).norm(), kTolerance);
  EXPECT_LT((corners[2] - Vector3d(1.0, 2.25, 3.25)).norm(), kTolerance);
  EXPECT_LT((corners[3] - Vector3d(1.0, 1.75, 3.25)).norm(), kTolerance);
}

TEST(Marker, CornersTurnWithYawAndRoll) {
  // The normal points along -y; the viewer has +x to the right. Turned by a quarter
  // counter-clockwise, the lower-left corner is at the lower right.
  const Corners<Vector3d> corners =
      hang({1.0, 2.0, 3.0}, radians(-90.0), radians(90.0), 2.0).corners();
  EXPECT_LT((corners[0] - Vector3d(2.0, 2.0, 2.0)).norm(), kTolerance);
  EXPECT_LT((corners[1] - Vector3d(2.0, 2.0, 4.0)).norm(), kTolerance);
  EXPECT_LT((corners[2] - Vector3d(0.0, 2.0, 4.0)).norm(), kTolerance);
  EXPECT_LT((corners[3] - Vector3d(0.0, 2.0, 2.0)).norm(), kTolerance);
}

TEST(Marker, CenterAndNormal) {
  const Marker marker = hang({1.0, 2.0, 3.0}, radians(30.0), 1.0, 0.3);
  EXPECT_LT((marker.center() - Vector3d(1.0, 2.0, 3.0)).norm(), kTolerance);
  EXPECT_LT((marker.normal() - Vector3d(std::sqrt(0.75), 0.5, 0.0)).norm(), kTolerance);
}

}  // namespace
}  // namespace omnitag
