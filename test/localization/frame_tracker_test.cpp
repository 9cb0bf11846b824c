#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <set>

#include "../support/level_floor.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "marker/marker_prediction.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

/// What a localizer finds in one frame of a robot that stands at a known place among markers.
class FrameTrackerTest : public testing::TestWithParam<Eigen::Isometry3d> {
 protected:
  static Pose truth() { return {0.25, -0.15, 0.6}; }

  MountedCamera camera() const { return {model_, GetParam()}; }

  static MarkerMap ring() {
    MarkerMap map;
    for (int i = 0; i < 7; ++i) {
      const double direction = 2.0 * kPi * i / 7 + 0.15 * (i % 2);
      map.markers.push_back(test::wallMarker(
          3 * i, {3.5 * std::cos(direction), 3.5 * std::sin(direction), 1.0 + 0.08 * i},
          direction + kPi));
    }
    return map;
  }

  /// Looks for the markers of `map` in a panorama of `seen`, from a prediction.
  FrameResult track(const MarkerMap& seen, const MarkerMap& map, const PoseEstimate& predicted,
                    const LocalizerConfig& config = test::onLevelFloor(),
                    bool wants_views = false) const {
    Localizer localizer(model_, map, config);
    localizer.setPose(predicted);
    Frame frame{0.0, test::renderPanorama(seen, camera(), truth(), 4), GetParam(), std::nullopt};
    frame.wants_views = wants_views;
    return localizer.process(frame);
  }

  static PoseEstimate nearby(double position, double heading) {
    const Eigen::Vector3d deviations(position, position, heading);
    return floorEstimate(truth(), deviations.cwiseAbs2().asDiagonal());
  }

  /// A prediction that is off by its deviations: its position toward `direction`, its heading to
  /// either side in turn.
  static PoseEstimate offBy(double position, double heading, double direction, int turn) {
    PoseEstimate predicted = nearby(position, heading);
    predicted.pose.x += position * std::cos(direction);
    predicted.pose.y += position * std::sin(direction);
    predicted.pose.yaw += turn % 2 == 0 ? heading : -heading;
    return predicted;
  }

  static LocalizerConfig decoding() {
    LocalizerConfig config = test::onLevelFloor();
    config.estimation.kind = EstimatorKind::kReprojection;
    return config;
  }

  static bool accepts(const FrameResult& result, std::size_t entry) {
    return std::any_of(result.detections.begin(), result.detections.end(),
                       [entry](const MarkerDetection& detection) {
                         return detection.accepted && detection.map_entry == entry;
                       });
  }

  static std::set<std::size_t> shown(const FrameResult& result) {
    std::set<std::size_t> targets;
    for (const View& view : result.views) targets.insert(view.targets.begin(), view.targets.end());
    return targets;
  }

  std::shared_ptr<const CameraModel> model_ = test::sphericalCamera();
};

TEST_P(FrameTrackerTest, AcceptsAMarkerThatIsTooSmallForTheDecoder) {
  MarkerMap map = ring();
  map.markers[2].size = 0.26;
  const PoseEstimate predicted = nearby(0.01, radians(0.3));
  const VisibilityConfig visibility;
  const auto small = predictMarker(map, 2, camera(), predicted, visibility);
  ASSERT_TRUE(small);
  const double edge = longestEdge(small->corners);
  ASSERT_LT(edge, visibility.min_decodable_edge_pixels);
  ASSERT_FALSE(accepts(track(map, map, predicted, decoding()), 2));
  const FrameResult result = track(map, map, predicted);
  EXPECT_TRUE(accepts(result, 2));
  for (const MarkerDetection& detection : result.detections) {
    if (detection.map_entry != std::optional<std::size_t>(2)) continue;
    EXPECT_LT((detection.center - *camera().pixelFromMap(truth(), map.markers[2].center())).norm(),
              0.2);
  }
}

TEST_P(FrameTrackerTest, AnotherTagAtAPredictedPlaceIsNotAccepted) {
  const MarkerMap map = ring();
  MarkerMap seen = map;
  seen.markers[1].id = 100;                // of no marker of the map
  seen.markers[4].id = map.markers[0].id;  // of another one
  seen.markers[5].map_from_marker.rotate(
      Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitZ()));  // upside down
  const FrameResult result = track(seen, map, nearby(0.02, radians(0.5)));
  ASSERT_TRUE(result.map_from_base);
  EXPECT_LT(test::positionError(result.map_from_base->pose, truth()), 2e-3);
  for (const std::size_t entry : {0U, 2U, 3U, 6U}) EXPECT_TRUE(accepts(result, entry)) << entry;
  for (const std::size_t entry : {1U, 4U, 5U}) EXPECT_FALSE(accepts(result, entry)) << entry;
}

TEST_P(FrameTrackerTest, ABlankBoardAtAPredictedPlaceIsNotAccepted) {
  const MarkerMap map = ring();
  MarkerMap seen = map;
  seen.markers.erase(seen.markers.begin() + 3);
  const FrameResult result = track(seen, map, nearby(0.02, radians(0.5)));
  ASSERT_TRUE(result.map_from_base);
  EXPECT_EQ(result.acceptedMarkers(), 6);
  EXPECT_FALSE(accepts(result, 3));
}

TEST_P(FrameTrackerTest, AMarkerThatHangsALittleElsewhereIsNotAccepted) {
  const MarkerMap map = ring();
  MarkerMap seen = map;
  seen.markers[3].map_from_marker.translate(Eigen::Vector3d(0.15, 0.0, 0.0));
  const FrameResult result = track(seen, map, nearby(0.02, radians(0.5)));
  ASSERT_TRUE(result.map_from_base);
  EXPECT_FALSE(accepts(result, 3));
  EXPECT_EQ(result.acceptedMarkers(), 6);
  EXPECT_LT(test::positionError(result.map_from_base->pose, truth()), 2e-3);
}

TEST_P(FrameTrackerTest, ATurnedMarkerThatTwoViewsShowIsReportedOnce) {
  MarkerMap map = ring();
  const double beside = 0.35;
  map.markers.push_back(
      test::wallMarker(50, {3.5 * std::cos(beside), 3.5 * std::sin(beside), 1.0}, beside + kPi));
  MarkerMap seen = map;
  seen.markers[0].map_from_marker.rotate(Eigen::AngleAxisd(kPi / 2.0, Eigen::Vector3d::UnitZ()));
  LocalizerConfig config = decoding();
  config.view.max_merged_half_width = 0.0;
  const FrameResult result = track(seen, map, nearby(0.1, radians(9.0)), config);
  ASSERT_EQ(result.mode, Mode::kTracking);
  const auto reported = std::count_if(
      result.detections.begin(), result.detections.end(),
      [](const MarkerDetection& detection) { return detection.id == 0 && !detection.accepted; });
  EXPECT_EQ(reported, 1);
}

TEST_P(FrameTrackerTest, ShowsAViewOfEveryPredictedMarkerToWhoWantsThem) {
  MarkerMap map = ring();
  map.markers[2].size = 0.26;
  const PoseEstimate predicted = nearby(0.01, radians(0.3));
  const FrameResult result = track(map, map, predicted, test::onLevelFloor(), true);
  ASSERT_EQ(result.predicted.size(), 7U);
  EXPECT_EQ(shown(result).size(), 7U);
  ASSERT_EQ(result.view_images.size(), result.views.size());
  for (std::size_t i = 0; i < result.views.size(); ++i) {
    EXPECT_EQ(result.view_images[i].size(), result.views[i].size);
    double darkest = 0.0;
    double lightest = 0.0;
    cv::minMaxLoc(result.view_images[i], &darkest, &lightest);
    EXPECT_LT(darkest, 80.0);
    EXPECT_GT(lightest, 170.0);
  }
  const FrameResult plain = track(map, map, predicted);
  EXPECT_LT(shown(plain).size(), 7U);
  ASSERT_TRUE(result.map_from_base && plain.map_from_base);
  EXPECT_EQ(result.map_from_base->pose.x, plain.map_from_base->pose.x);
  EXPECT_EQ(result.map_from_base->pose.y, plain.map_from_base->pose.y);
  EXPECT_EQ(result.map_from_base->pose.yaw, plain.map_from_base->pose.yaw);
  EXPECT_EQ(result.acceptedMarkers(), plain.acceptedMarkers());
}

TEST_P(FrameTrackerTest, FindsAllMarkersFromAPoorPrediction) {
  const MarkerMap map = ring();
  for (int i = 0; i < 6; ++i) {
    const FrameResult result = track(map, map, offBy(0.05, radians(2.0), kPi / 3.0 * i, i));
    ASSERT_TRUE(result.map_from_base) << i;
    EXPECT_EQ(result.mode, Mode::kTracking) << i;
    EXPECT_EQ(result.acceptedMarkers(), 7) << i;
    EXPECT_LT(test::positionError(result.map_from_base->pose, truth()), 1e-3) << i;
    EXPECT_NEAR(result.map_from_base->pose.yaw, truth().yaw, radians(0.03)) << i;
  }
}

TEST_P(FrameTrackerTest, FindsAllSmallMarkersFromAVaguePrediction) {
  MarkerMap map = ring();
  for (Marker& marker : map.markers) marker.size = 0.4;
  for (int i = 0; i < 12; ++i) {
    const FrameResult result = track(map, map, offBy(0.3, radians(10.0), kPi / 6.0 * i, i));
    ASSERT_TRUE(result.map_from_base) << i;
    EXPECT_LT(test::positionError(result.map_from_base->pose, truth()), 2e-3) << i;
    std::set<std::size_t> entries;
    for (const MarkerDetection& detection : result.detections) {
      if (detection.map_entry) entries.insert(*detection.map_entry);
    }
    EXPECT_EQ(entries.size(), 7U) << i;
    // The decoder may read the corners of such a small marker pixels off.
    EXPECT_GE(result.acceptedMarkers(), 6) << i;
  }
}

TEST_P(FrameTrackerTest, TheSharperThePredictionTheFewerViewsAreDecoded) {
  const MarkerMap map = ring();
  // Not counting the view that is read for markers that are not expected.
  const auto forExpected = [](const FrameResult& result) {
    return std::count_if(result.views.begin(), result.views.end(),
                         [](const View& view) { return !view.targets.empty(); });
  };
  const FrameResult sharp = track(map, map, nearby(0.005, radians(0.2)));
  EXPECT_EQ(forExpected(sharp), 0);
  EXPECT_EQ(sharp.acceptedMarkers(), 7);
  const FrameResult vague = track(map, map, nearby(0.15, radians(20.0)));
  EXPECT_GT(forExpected(vague), 0);
  EXPECT_EQ(vague.acceptedMarkers(), 7);
}

INSTANTIATE_TEST_SUITE_P(Mountings, FrameTrackerTest,
                         testing::Values(test::lookingDown(), test::lookingUp()),
                         [](const auto& test) { return test.index == 0 ? "Down" : "Up"; });

}  // namespace
}  // namespace omnitag
