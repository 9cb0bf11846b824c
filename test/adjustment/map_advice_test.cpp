#include "adjustment/map_advice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "../support/sample_markers.h"
#include "adjustment/wall_groups.h"

namespace omnitag {
namespace {

using Lines = std::vector<std::string>;

/// A marker whose place is known to `deviation` (m), well seen from 7.5 m and farther.
BuiltMarker known(const Marker& marker, double deviation) {
  BuiltMarker built;
  built.marker = marker;
  built.covariance.diagonal().setConstant(deviation * deviation);
  built.sightings = 40;
  built.seen = {7.5, radians(60.0)};
  return built;
}

TEST(WallGroupsTest, AreTheWallsOfARoom) {
  const auto groups = groupedByWall(test::roomMarkers());
  ASSERT_EQ(groups.size(), 4U);
  EXPECT_EQ(groups[0], (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(groups[1], (std::vector<std::size_t>{3, 4}));
  EXPECT_EQ(groups[2], (std::vector<std::size_t>{5, 6}));
  EXPECT_EQ(groups[3], (std::vector<std::size_t>{7, 8, 9}));
}

TEST(WallGroupsTest, HaveAPlaceInWords) {
  const auto wall = [](double x, double y, double yaw) {
    return test::wallMarker(1, {x, y, 1.0}, yaw);
  };
  EXPECT_EQ(placeOf({wall(9.1, 1.0, kPi), wall(9.3, 2.0, kPi)}), "on the wall at x = 9.2 m");
  EXPECT_EQ(placeOf({wall(1.0, -3.0, kPi / 2), wall(2.0, -3.0, kPi / 2)}),
            "on the wall at y = -3.0 m");
  EXPECT_EQ(placeOf({wall(1.0, 2.0, 0.7), wall(2.0, 1.0, 0.7)}), "on the wall around (1.5, 1.5)");
  EXPECT_EQ(placeOf({wall(1.0, 2.0, 0.0)}), "at (1.0, 2.0)");
  const Marker lying = test::lyingMarker(1, {1.0, 2.0, 0.0}, true, 0.0, 0.5);
  EXPECT_EQ(placeOf({lying, lying}), "on the floor");
  const Marker hanging = test::lyingMarker(1, {1.0, 2.0, 3.0}, false, 0.0, 0.5);
  EXPECT_EQ(placeOf({hanging, hanging}), "under the ceiling");
}

TEST(SeenFromTest, IsTheNearestPlaceAndTheAngle) {
  std::vector<MarkerSighting> sightings(2);
  sightings[1].map_from_base.pose.x = 2.0;
  const SeenFrom seen = seenFrom({1.0, 1.0, 0.0}, sightings);
  EXPECT_NEAR(seen.nearest, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(seen.parallax, radians(90.0), 1e-6);
  EXPECT_EQ(seenFrom({1.0, 1.0, 0.0}, {}).nearest, 0.0);
}

TEST(MapAdviceTest, SaysWhereToDriveNearer) {
  BuiltMap map;
  for (const int id : {3, 7, 12}) {
    map.markers.push_back(known(test::wallMarker(id, {9.2, 0.5 * id, 1.0}, kPi), 0.04));
  }
  for (const int id : {20, 21, 22}) {
    map.markers.push_back(known(test::wallMarker(id, {-2.0, 0.1 * id, 1.0}, 0.0), 0.003));
  }
  BuiltMarker exact;
  exact.is_exact = true;
  map.markers.push_back(exact);
  EXPECT_EQ(adviceOn(map),
            (Lines{"drive nearer to markers 3, 7 and 12 on the wall at x = 9.2 m, seen from 7.5 m "
                   "at the nearest: they are known to 4.0 cm",
                   "the 3 other markers that were found are known to 3.0 mm or better"}));
}

TEST(MapAdviceTest, SaysWhatElseHelps) {
  BuiltMap map;
  map.markers = {known(test::wallMarker(1, {4.0, 1.0, 1.0}, kPi), 0.001),
                 known(test::wallMarker(2, {4.0, 2.0, 1.0}, kPi), 0.008)};
  map.markers[1].sightings = 4;
  // Left out of the map.
  map.uncertain = {known(test::wallMarker(5, {1.0, 2.0, 1.0}, 0.0), 0.032)};
  map.uncertain[0].marker.name = "door";
  map.uncertain[0].seen.parallax = radians(8.0);
  EXPECT_EQ(adviceOn(map),
            (Lines{"drive past marker 5 (door) at (1.0, 2.0), seen from directions up to 8 degrees "
                   "apart: it is known to 3.2 cm",
                   "keep marker 2 at (4.0, 2.0) in sight for longer, read in up to 4 images: it is "
                   "known to 8.0 mm",
                   "the other marker that was found is known to 1.0 mm"}));
}

TEST(MapAdviceTest, SaysIfNothingIsLeftToDo) {
  BuiltMap map;
  EXPECT_TRUE(adviceOn(map).empty());
  for (const int id : {1, 2}) {
    map.markers.push_back(known(test::wallMarker(id, {4.0, 1.0 * id, 1.0}, kPi), 0.001 * id));
  }
  EXPECT_EQ(adviceOn(map),
            Lines{"nothing to do; all 2 markers that were found are known to 2.0 mm or better"});
}

}  // namespace
}  // namespace omnitag
