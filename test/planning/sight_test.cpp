#include "planning/sight.h"

#include <gtest/gtest.h>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "building.h"

namespace omnitag {
namespace {

Marker smallMarker(const Eigen::Vector3d& center, double yaw) {
  Marker marker = test::wallMarker(0, center, yaw);
  marker.size = 0.3;
  return marker;
}

constexpr double kWallDepth = 0.1;
const Eigen::Vector3d kWest(-2.0, 0.0, 1.0);

TEST(Sight, EndsAtWalls) {
  const OccupancyGrid grid = test::twoRooms();
  // On the eastern wall of the other room: through the door, and hidden behind the wall.
  EXPECT_TRUE(isInSight(grid, kWest, smallMarker({4.0, 0.0, 1.2}, kPi), kWallDepth));
  EXPECT_FALSE(isInSight(grid, kWest, smallMarker({4.0, 1.7, 1.2}, kPi), kWallDepth));
  // Half of it is behind the frame of the door: the line of sight to its middle passes at x = 0
  // at y = 0.45, to one end of it at 0.5.
  EXPECT_FALSE(isInSight(grid, kWest, smallMarker({4.0, 1.35, 1.2}, kPi), kWallDepth));
}

TEST(Sight, TheWallOnWhichAMarkerHangsDoesNotHideIt) {
  const OccupancyGrid grid = test::twoRooms();
  // In the wall's cells, since walls are thicker in grids.
  EXPECT_TRUE(isInSight(grid, kWest, smallMarker({-4.06, 0.5, 1.2}, 0.0), kWallDepth));
  EXPECT_TRUE(isInSight(grid, kWest, smallMarker({-0.02, -1.4, 1.2}, kPi), kWallDepth));
  // Seen aslant along the wall.
  EXPECT_TRUE(isInSight(grid, {-3.6, -1.8, 1.0}, smallMarker({-4.03, -0.5, 1.2}, 0.0), kWallDepth));
  // But not through a wall.
  EXPECT_FALSE(isInSight(grid, {2.0, -1.4, 1.0}, smallMarker({-0.1, -1.4, 1.2}, kPi), kWallDepth));
}

TEST(Sight, UnknownCellsHide) {
  const test::FloorDrawing drawing =
      test::FloorDrawing(4.0, 2.0).free(0.0, 0.0, 1.5, 2.0).free(2.0, 0.0, 4.0, 2.0);
  const OccupancyGrid grid(drawing.image(), test::gridFileAt(0.0, 0.0));
  EXPECT_FALSE(isInSight(grid, {0.5, 1.0, 1.0}, smallMarker({3.9, 1.0, 1.2}, kPi), kWallDepth));
  EXPECT_TRUE(isInSight(grid, {2.5, 1.0, 1.0}, smallMarker({3.9, 1.0, 1.2}, kPi), kWallDepth));
}

TEST(Sight, SmallOnesAreNotRecognizedFromAfar) {
  const OccupancyGrid grid = test::twoRooms();
  const MountedCamera camera(test::sphericalCamera(), test::lookingDown());
  const PlanningScene scene{grid, camera, {}};
  MarkerMap map;
  map.markers = {smallMarker({-4.0, 0.0, 1.2}, 0.0)};
  const PatternEdges edges = edgesOf(map.markers[0]);
  EXPECT_TRUE(isRecognized(scene, map, 0, edges, {-3.0, 0.0, 0.3}));
  EXPECT_FALSE(isRecognized(scene, map, 0, edges, {3.0, 0.0, 0.3}));
  // Nor from behind.
  map.markers = {smallMarker({-1.0, 0.0, 1.2}, 0.0)};
  EXPECT_FALSE(isRecognized(scene, map, 0, edges, {-2.0, 0.0, 0.3}));
}

}  // namespace
}  // namespace omnitag
