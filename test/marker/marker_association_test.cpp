#include "marker/marker_association.h"

#include <gtest/gtest.h>

namespace omnitag {
namespace {

Corners<Eigen::Vector2d> square(const Eigen::Vector2d& center, double edge, double roll = 0.0) {
  Corners<Eigen::Vector2d> corners;
  const Eigen::Rotation2Dd turn(roll);
  corners[0] = center + turn * Eigen::Vector2d(-edge / 2, -edge / 2);
  corners[1] = center + turn * Eigen::Vector2d(edge / 2, -edge / 2);
  corners[2] = center + turn * Eigen::Vector2d(edge / 2, edge / 2);
  corners[3] = center + turn * Eigen::Vector2d(-edge / 2, edge / 2);
  return corners;
}

class AssociationTest : public testing::Test {
 protected:
  AssociationTest() {
    for (const int id : {5, 6, 5}) {
      Marker marker;
      marker.family = "tag36h11";
      marker.id = id;
      map_.markers.push_back(marker);
    }
    const Eigen::Vector2d places[] = {{100, 100}, {100, 100}, {130, 100}};
    for (std::size_t i = 0; i < map_.markers.size(); ++i) {
      PredictedMarker prediction;
      prediction.map_entry = i;
      prediction.center = places[i];
      prediction.corners = square(places[i], 40.0);
      prediction.tangential_margin = prediction.radial_margin = 3.0;
      predictions_.push_back(prediction);
    }
  }

  Association match(int id, const Eigen::Vector2d& center, double edge = 40.0, double roll = 0.0,
                    const std::string& family = "tag36h11") const {
    return associate({family, id, 0, square(center, edge, roll), center, 0}, predictions_, map_,
                     {});
  }

  MarkerMap map_;
  std::vector<PredictedMarker> predictions_;
};

TEST_F(AssociationTest, TakesTheNearestOfThoseThatFit) {
  EXPECT_EQ(match(5, {103, 101}).prediction, 0U);
  EXPECT_EQ(match(5, {128, 101}).prediction, 2U);
  EXPECT_EQ(match(6, {103, 101}).prediction, 1U);
}

TEST_F(AssociationTest, RefusesAnotherIdOrFamily) {
  EXPECT_FALSE(match(7, {100, 100}).prediction);
  EXPECT_NE(match(7, {100, 100}).reason, "");
  EXPECT_FALSE(match(5, {100, 100}, 40.0, 0.0, "tag25h9").prediction);
}

TEST_F(AssociationTest, SaysHowFarOffWhatIsFarOff) {
  const Association association = match(6, {100, 160});
  EXPECT_FALSE(association.prediction);
  EXPECT_NE(association.reason.find("60.0 px"), std::string::npos) << association.reason;
}

TEST_F(AssociationTest, RefusesAnotherSize) {
  EXPECT_TRUE(match(6, {100, 100}, 50.0).prediction);
  const Association larger = match(6, {100, 100}, 70.0);
  EXPECT_FALSE(larger.prediction);
  EXPECT_NE(larger.reason.find("1.75 times"), std::string::npos) << larger.reason;
  EXPECT_FALSE(match(6, {100, 100}, 20.0).prediction);
}

TEST_F(AssociationTest, RefusesAnotherRoll) {
  EXPECT_TRUE(match(6, {100, 100}, 40.0, 0.3).prediction);
  const Association turned = match(6, {100, 100}, 40.0, kPi / 2);
  EXPECT_FALSE(turned.prediction);
  EXPECT_NE(turned.reason.find("90 degrees"), std::string::npos) << turned.reason;
  EXPECT_FALSE(match(6, {100, 100}, 40.0, kPi).prediction);
}

TEST_F(AssociationTest, OnlyWhatIsPredictedCounts) {
  const Association association =
      associate({"tag36h11", 5, 0, square({100, 100}, 40), {100, 100}, 0},
                {predictions_[1], predictions_[2]}, map_, {});
  EXPECT_EQ(association.prediction, std::nullopt);
}

}  // namespace
}  // namespace omnitag
