#include "planning/floor_prediction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "building.h"
#include "planning/plan_picture.h"
#include "planning/plan_report.h"

namespace omnitag {
namespace {

class FloorPredictionTest : public testing::Test {
 protected:
  FloorPredictionTest() {
    map_.markers = {test::wallMarker(0, {-4.0, 0.5, 1.2}, 0.0),
                    test::wallMarker(1, {-3.0, 2.0, 1.2}, -kPi / 2),
                    test::wallMarker(2, {-1.5, -2.0, 1.4}, kPi / 2)};
    for (Marker& marker : map_.markers) marker.deviation = 0.005;
  }

  FloorPrediction predicted(int headings, Headings summary, int threads = 1) const {
    const FloorPrediction places = placesOn(grid_, 0.4, 0.2);
    return predictFloor(scene_, map_, places, headings, summary, threads);
  }

  OccupancyGrid grid_ = test::twoRooms();
  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
  PlanningScene scene_{grid_, camera_, {}};
  MarkerMap map_;
};

TEST_F(FloorPredictionTest, PlacesAreWhereARobotFits) {
  const FloorPrediction floor = placesOn(grid_, 0.4, 0.3);
  EXPECT_DOUBLE_EQ(floor.step, 0.4);
  for (const PlacePrediction& place : floor.places) {
    const double x = std::abs(place.place.x());
    const double y = std::abs(place.place.y());
    EXPECT_LT(std::max(x - 2.0, y), 1.75);
    if (y > 0.5) {
      EXPECT_GT(x, 0.3);
    }
  }
  // Of 7.4 x 3.4 m, a strip of 0.7 x 2.6 m along the wall is left out.
  EXPECT_NEAR(static_cast<double>(floor.places.size()), (7.4 * 3.4 - 0.7 * 2.6) / 0.16, 20.0);
}

TEST_F(FloorPredictionTest, AStepIsChosenForTheSizeOfTheFloor) {
  const FloorPrediction floor = placesOn(grid_, 0.0, 0.2);
  EXPECT_GT(floor.places.size(), 2000U);
  EXPECT_LT(floor.places.size(), 6000U);
}

TEST_F(FloorPredictionTest, MarkersAreSeenInTheirRoom) {
  const FloorPrediction floor = predicted(4, Headings::kWorst);
  for (const PlacePrediction& place : floor.places) {
    EXPECT_EQ(place.position_deviation.has_value(), place.markers > 0);
    if (place.markers > 0 && place.place.x() > 0.2) {
      // Through the door, seen from somewhere near the robot's middle.
      EXPECT_TRUE(std::any_of(map_.markers.begin(), map_.markers.end(), [&](const Marker& marker) {
        const Eigen::Vector2d way = marker.center().head<2>() - place.place;
        const double at_door = place.place.y() - place.place.x() * way.y() / way.x();
        return std::abs(at_door) < 0.6;
      })) << place.place.transpose();
    }
    const bool is_well_inside =
        place.place.x() > -2.8 && place.place.x() < -1.7 && std::abs(place.place.y()) < 0.8;
    if (is_well_inside) {
      EXPECT_EQ(place.markers, 3) << place.place.transpose();
    }
  }
}

TEST_F(FloorPredictionTest, TheWorstHeadingIsWorseThanTheirMean) {
  const FloorPrediction worst = predicted(4, Headings::kWorst);
  const FloorPrediction mean = predicted(4, Headings::kMean);
  const FloorPrediction one = predicted(1, Headings::kMean);
  for (std::size_t i = 0; i < worst.places.size(); ++i) {
    EXPECT_LE(worst.places[i].markers, mean.places[i].markers);
    if (!worst.places[i].position_deviation) continue;
    EXPECT_GE(*worst.places[i].position_deviation, *mean.places[i].position_deviation);
    EXPECT_GE(*worst.places[i].position_deviation,
              one.places[i].position_deviation.value_or(0.0) - 1e-12);
  }
}

TEST_F(FloorPredictionTest, ThreadsDoNotMatter) {
  EXPECT_EQ(csvText(predicted(2, Headings::kWorst, 1)), csvText(predicted(2, Headings::kWorst, 3)));
}

TEST_F(FloorPredictionTest, TheSummaryCountsPlaces) {
  FloorPrediction floor;
  for (int i = 0; i < 20; ++i) {
    PlacePrediction place;
    place.place = {0.1 * i, 1.0};
    place.markers = i / 4;
    if (i >= 4) place.position_deviation = place.heading_deviation = 0.001 * i;
    floor.places.push_back(place);
  }
  const FloorSummary summary = summaryOf(floor);
  EXPECT_NEAR(summary.by_markers[0], 0.2, 1e-12);
  EXPECT_NEAR(summary.by_markers[3], 0.4, 1e-12);
  EXPECT_NEAR(summary.median_position, 0.012, 1e-12);
  ASSERT_TRUE(summary.worst);
  // Of the places without a marker, the one farthest from those with one.
  EXPECT_EQ(summary.worst->place, Eigen::Vector2d(0.0, 1.0));
  const std::string csv = csvText(floor);
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "x,y,markers,position_deviation,heading_deviation");
  EXPECT_NE(csv.find("\n0.300,1.000,0,,\n"), std::string::npos);
  EXPECT_NE(csv.find("\n0.800,1.000,2,0.008000,0.008000\n"), std::string::npos);
}

TEST_F(FloorPredictionTest, ThePictureShowsFloorWallsAndMarkers) {
  const FloorPrediction floor = predicted(2, Headings::kWorst);
  const cv::Mat picture = planPicture(grid_, floor, map_, 1);
  ASSERT_EQ(picture.type(), CV_8UC3);
  EXPECT_GT(picture.cols, 900);
  const auto pixelsOf = [&](const cv::Vec3b& colour) {
    int count = 0;
    for (const cv::Vec3b& pixel : cv::Mat_<cv::Vec3b>(picture)) count += pixel == colour ? 1 : 0;
    return count;
  };
  EXPECT_GT(pixelsOf({205, 205, 205}), 20000);  // no marker in most of the eastern room
  EXPECT_GT(pixelsOf({90, 90, 90}), 5000);      // walls
  EXPECT_GT(pixelsOf({190, 20, 190}), 50);      // the new marker
}

}  // namespace
}  // namespace omnitag
