#include "planning/marker_placement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "building.h"
#include "omnitag/common/error.h"
#include "planning/floor_prediction.h"
#include "planning/wall_places.h"

namespace omnitag {
namespace {

TEST(WallPlaces, AreOnFlatWallsOnBothSides) {
  const OccupancyGrid grid = test::twoRooms();
  constexpr double kWidth = 0.4;
  constexpr double kSpacing = 0.5;
  const std::vector<WallPlace> places = wallPlaces(grid, kWidth, kSpacing);
  int on_western_side = 0;
  int on_eastern_side = 0;
  for (const WallPlace& place : places) {
    const double x = place.position.x();
    const double y = place.position.y();
    const Eigen::Vector2d normal(std::cos(place.yaw), std::sin(place.yaw));
    const bool is_north_or_south = std::abs(std::abs(y) - 2.0) < 1e-3;
    const bool is_on_middle = std::abs(std::abs(x) - 0.05) < 1e-3;
    EXPECT_TRUE(is_north_or_south || is_on_middle || std::abs(std::abs(x) - 4.0) < 1e-3)
        << place.position.transpose();
    const Eigen::Vector2d into_room =
        is_north_or_south ? Eigen::Vector2d(0.0, -y) : Eigen::Vector2d(is_on_middle ? x : -x, 0.0);
    EXPECT_GT(normal.dot(into_room.normalized()), 0.9999);
    on_western_side += is_on_middle && x < 0.0 ? 1 : 0;
    on_eastern_side += is_on_middle && x > 0.0 ? 1 : 0;
    // Neither across the corner of a room nor beyond the frame of the door.
    if (is_north_or_south) {
      EXPECT_LT(std::abs(std::abs(x) - 2.025), 1.975 - 0.5 * kWidth + 0.05);
    }
    if (is_on_middle) {
      EXPECT_GT(std::abs(y), 0.5 + 0.5 * kWidth - 0.05);
    }
    for (const WallPlace& other : places) {
      const double distance = (other.position - place.position).norm();
      if (&other != &place && std::abs(other.yaw - place.yaw) < 1.0) {
        EXPECT_GE(distance, kSpacing - test::kCellSize);
      }
    }
  }
  EXPECT_GE(on_western_side, 4);
  EXPECT_GE(on_eastern_side, 4);
  // The walls around each of the rooms, less what is too near a corner.
  EXPECT_GT(places.size(), 40U);
}

TEST(WallPlaces, AreFoundInAGridThatIsTurned) {
  constexpr double kTurn = 0.4;
  cv::Mat image(120, 120, CV_8UC1, cv::Scalar(0));
  // A room of 4 x 3 m, turned within the image.
  std::vector<cv::Point> corners;
  const Eigen::Rotation2Dd turn(kTurn);
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(-2.0, -1.5), Eigen::Vector2d(2.0, -1.5),
                                        Eigen::Vector2d(2.0, 1.5), Eigen::Vector2d(-2.0, 1.5)}) {
    const Eigen::Vector2d cell = turn * corner / test::kCellSize;
    corners.emplace_back(60 + cvRound(cell.x()), 60 - cvRound(cell.y()));
  }
  cv::fillConvexPoly(image, corners, 254);
  const OccupancyGrid grid(image, test::gridFileAt(-3.0, -3.0));
  const std::vector<WallPlace> places = wallPlaces(grid, 0.5, 0.5);
  // 14 m of walls.
  EXPECT_GT(places.size(), 15U);
  EXPECT_LT(places.size(), 29U);
  for (const WallPlace& place : places) {
    const Eigen::Vector2d in_room = turn.inverse() * place.position;
    const bool is_long = std::abs(std::abs(in_room.y()) - 1.5) < 0.08;
    EXPECT_TRUE(is_long || std::abs(std::abs(in_room.x()) - 2.0) < 0.08) << in_room.transpose();
    const Eigen::Vector2d normal =
        turn.inverse() * Eigen::Vector2d(std::cos(place.yaw), std::sin(place.yaw));
    const double cosine = is_long ? std::copysign(normal.y(), -normal.y() * in_room.y())
                                  : std::copysign(normal.x(), -normal.x() * in_room.x());
    EXPECT_GT(cosine, std::cos(0.06)) << in_room.transpose();
  }
}

class MarkerPlacementTest : public testing::Test {
 protected:
  MarkerPlacementTest() {
    map_.markers = {test::wallMarker(0, {-4.0, 0.5, 1.2}, 0.0),
                    test::wallMarker(2, {-3.0, 2.0, 1.2}, -kPi / 2),
                    test::wallMarker(3, {-1.5, -2.0, 1.4}, kPi / 2),
                    test::wallMarker(5, {-2.5, -2.0, 1.4}, kPi / 2)};
  }

  std::vector<Pose> poses() const { return posesAt(placesOn(grid_, 0.4, 0.2).places, 2); }

  OccupancyGrid grid_ = test::twoRooms();
  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
  PlanningScene scene_{grid_, camera_, {}};
  MarkerMap map_;
};

TEST_F(MarkerPlacementTest, NewMarkersHangWhereTheyAreMissing) {
  const NewMarkers wanted{3, 0.5, 1.3, "tag36h11"};
  const MarkerPlacement placement = placeMarkers(scene_, map_, poses(), wanted, 2);
  ASSERT_EQ(placement.markers.size(), 3U);
  std::set<int> ids;
  for (const Marker& marker : placement.markers) {
    ids.insert(marker.id);
    EXPECT_EQ(marker.size, 0.5);
    EXPECT_EQ(marker.center().z(), 1.3);
    EXPECT_EQ(marker.deviation, 0.005);
    EXPECT_EQ(marker.orientation_deviation, 0.0175);
    for (const Marker& other : map_.markers) {
      EXPECT_GT((marker.center() - other.center()).norm(), 0.6);
    }
  }
  EXPECT_EQ(ids, (std::set<int>{1, 4, 6}));
  // The eastern room has none.
  EXPECT_GT(placement.markers[0].center().x(), 0.0);
  EXPECT_GT(placement.markers[1].center().x(), 0.0);
  EXPECT_GE(placement.guaranteed_share, 1.0 - std::exp(-1.0));
  EXPECT_LE(placement.guaranteed_share, 1.0);

  MarkerMap after = map_;
  after.markers.insert(after.markers.end(), placement.markers.begin(), placement.markers.end());
  const FloorPrediction places = placesOn(grid_, 0.4, 0.2);
  const auto withoutMarker = [&](const MarkerMap& map) {
    const FloorPrediction floor = predictFloor(scene_, map, places, 2, Headings::kWorst, 2);
    return std::count_if(floor.places.begin(), floor.places.end(),
                         [](const PlacePrediction& place) { return place.markers == 0; });
  };
  EXPECT_GT(withoutMarker(map_), 25);
  EXPECT_LT(withoutMarker(after), 5);
}

TEST_F(MarkerPlacementTest, AFamilyHasOnlySoManyIds) {
  const auto refusalOf = [&](const NewMarkers& wanted) {
    try {
      placeMarkers(scene_, map_, poses(), wanted, 1);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusalOf({31, 0.3, 1.2, "tag16h5"}),
            "tag16h5 has 30 ids that the map does not use, expected at least 31");
  EXPECT_NE(refusalOf({1, 5.0, 1.2, "tag36h11"}).find("flat piece of wall at least 7.00 m wide"),
            std::string::npos);
}

}  // namespace
}  // namespace omnitag
