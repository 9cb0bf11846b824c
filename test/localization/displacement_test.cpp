#include "localization/displacement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"

namespace omnitag {
namespace {

class DisplacementTest : public testing::TestWithParam<Eigen::Isometry3d> {
 protected:
  /// The displacement of `hanging` according to `map`.
  std::optional<DisplacedMarker> displacementOf(const Marker& hanging, const MarkerMap& map) const {
    const MarkerReading reading = *test::exactReading(hanging, camera_, robot_);
    return displacement(map, camera_, reading.family, reading.id,
                        {0, reading.corners, reading.center}, robot_, PosePrior::upright(), {});
  }

  MountedCamera camera_{test::sphericalCamera(), GetParam()};
  Pose robot_{0.4, -0.3, 2.1};
  Marker mapped_ = test::wallMarker(6, {2.5, 0.9, 1.3}, kPi + 0.2);
};

TEST_P(DisplacementTest, TellsHowFarAMarkerWasMoved) {
  for (const Eigen::Vector2d& way : {Eigen::Vector2d(0.3, 0.0), Eigen::Vector2d(0.0, -0.5),
                                     Eigen::Vector2d(-0.6, 0.8), Eigen::Vector2d(0.1, 0.1)}) {
    Marker moved = mapped_;
    moved.map_from_marker.pretranslate(Eigen::Vector3d(way.x(), way.y(), 0.0));
    const auto found = displacementOf(moved, {"map", {mapped_}});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->map_entry, 0U);
    EXPECT_NEAR(found->distance, way.norm(), 0.1 * way.norm());
  }
}

TEST_P(DisplacementTest, TellsHowFarAMarkerWasMovedAndTurned) {
  Marker moved = test::wallMarker(6, {1.6, 2.0, 1.3}, -2.0);
  const auto found = displacementOf(moved, {"map", {mapped_}});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->distance, std::hypot(0.9, 1.1), 0.1 * std::hypot(0.9, 1.1));
}

TEST_P(DisplacementTest, OfSeveralEntriesTheNearestCounts) {
  const Marker far = test::wallMarker(6, {-2.5, 1.0, 1.3}, 0.0);
  const Marker other = test::wallMarker(7, {2.5, 0.8, 1.3}, kPi);
  Marker moved = mapped_;
  moved.map_from_marker.pretranslate(Eigen::Vector3d(-0.2, 0.3, 0.0));
  const auto found = displacementOf(moved, {"map", {far, other, mapped_}});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->map_entry, 2U);
  EXPECT_NEAR(found->distance, std::hypot(0.2, 0.3), 0.1 * std::hypot(0.2, 0.3));
}

TEST_P(DisplacementTest, OneThatHangsWhereItShouldIsNotDisplaced) {
  const auto found = displacementOf(mapped_, {"map", {mapped_}});
  ASSERT_TRUE(found);
  EXPECT_LT(found->distance, 2e-3);
}

TEST_P(DisplacementTest, WhatDoesNotLookLikeTheMapsMarkerTellsNothing) {
  for (const double roll : {45.0, 90.0, 180.0}) {
    Marker rolled = mapped_;
    rolled.map_from_marker.rotate(Eigen::AngleAxisd(radians(roll), Eigen::Vector3d::UnitZ()));
    EXPECT_FALSE(displacementOf(rolled, {"map", {mapped_}})) << roll;
  }
  Marker unknown = mapped_;
  unknown.id = 9;
  EXPECT_FALSE(displacementOf(unknown, {"map", {mapped_}}));
}

TEST(DisplacementLogTest, NamesWhatWasReadDisplacedAgainAndAgainUntilItIsReadInItsPlace) {
  DisplacementLog log;
  FrameResult displaced;
  displaced.displaced = {{3, 0.4}};
  log.add(displaced);
  EXPECT_TRUE(log.persistent().empty()) << "once may be chance";
  for (int i = 0; i < 10; ++i) {
    displaced.displaced[0].distance = i % 2 == 0 ? 0.5 : 0.3;
    log.add(displaced);
    log.add(FrameResult{});
  }
  ASSERT_EQ(log.persistent().size(), 1U);
  EXPECT_EQ(log.persistent()[0].map_entry, 3U);
  EXPECT_NEAR(log.persistent()[0].distance, 0.4, 1e-9);

  FrameResult in_place;
  in_place.detections.resize(1);
  in_place.detections[0].map_entry = 3;
  in_place.detections[0].accepted = true;
  log.add(in_place);
  EXPECT_TRUE(log.persistent().empty());
}

INSTANTIATE_TEST_SUITE_P(Mountings, DisplacementTest,
                         testing::Values(test::lookingDown(), test::lookingUp()),
                         [](const auto& test) { return test.index == 0 ? "Down" : "Up"; });

}  // namespace
}  // namespace omnitag
