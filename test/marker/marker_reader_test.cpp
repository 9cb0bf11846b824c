#include "marker/marker_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "view/view_planner.h"

namespace omnitag {
namespace {

constexpr double kWorkingDistance = 3.0;  // m

/// Four markers around the robot, two of which have the same id, and views all around that overlap
/// by half.
class MarkerReaderTest : public testing::Test {
 protected:
  MarkerReaderTest() {
    ViewTarget target;
    target.half_width = radians(45.0);
    target.distance = kWorkingDistance;
    const auto radiusAt = [this](double height) {
      return camera_.model().imageFromPoint(kWorkingDistance, height)->radius;
    };
    target.min_radius = std::min(radiusAt(-1.0), radiusAt(1.0));
    target.max_radius = std::max(radiusAt(-1.0), radiusAt(1.0));
    for (int i = 0; i < 8; ++i) {
      target.azimuth = normalizeAngle(radians(45.0) * i);
      ViewPlannerConfig planner;
      planner.max_size = 960;
      views_.push_back(planView(target, reader_.warper().table(),
                                camera_.model().imagePlane().scale(), camera_.axisUp(), planner));
    }
  }

  std::vector<MarkerReading> readEverywhere() const {
    const cv::Mat panorama = test::renderPanorama(map_, camera_, truth_);
    std::vector<MarkerReading> readings;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const cv::Mat image = reader_.warper().warp(panorama, views_[v]);
      for (MarkerReading& reading : reader_.read(image, views_[v])) {
        reading.view = v;
        readings.push_back(std::move(reading));
      }
    }
    return readings;
  }

  /// How far a reading is from where a marker really images: its worst corner, in pixels.
  double error(const MarkerReading& reading, const Marker& marker) const {
    const MarkerReading exact = *test::exactReading(marker, camera_, truth_);
    double worst = 0.0;
    for (std::size_t k = 0; k < exact.corners.size(); ++k) {
      worst = std::max(worst, (reading.corners[k] - exact.corners[k]).norm());
    }
    return worst;
  }

  /// Whether the view shows the marker with room around it, so that none of its edges is cut.
  bool isWhole(const MarkerReading& reading) const {
    const View& view = views_[reading.view];
    return std::all_of(reading.corners.begin(), reading.corners.end(), [&](const auto& corner) {
      constexpr double kRoom = 12.0;  // pixels
      const auto position = reader_.warper().viewFromPanorama(view, corner);
      return position && position->x() > kRoom && position->x() < view.size.width - kRoom;
    });
  }

  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
  MarkerMap map_{
      "map",
      {test::wallMarker(5, {3.0, 0.3, 1.2}, kPi), test::wallMarker(8, {-0.4, 3.2, 0.9}, -kPi / 2),
       test::wallMarker(5, {-2.8, -0.5, 1.5}, 0.0),
       test::wallMarker(11, {0.9, -3.1, 1.0}, kPi / 2, radians(30.0))}};
  Pose truth_{0.3, -0.2, 0.7};
  MarkerReader reader_{test::sphericalCamera(), kWorkingDistance, {}, {"tag36h11"}};
  std::vector<View> views_;
};

TEST_F(MarkerReaderTest, ReadsEveryMarkerWhereItImagesAndKeepsItOnce) {
  const std::vector<MarkerReading> all = readEverywhere();
  EXPECT_GT(all.size(), map_.markers.size());
  for (const MarkerReading& reading : all) {
    if (!isWhole(reading)) continue;
    double least = 1e9;
    for (const Marker& marker : map_.markers) {
      if (marker.id == reading.id) least = std::min(least, error(reading, marker));
    }
    EXPECT_LT(least, 0.3) << "id " << reading.id << " in view " << reading.view;
    EXPECT_EQ(reading.family, "tag36h11");
  }
  const std::vector<MarkerReading> kept = withoutRepetitions(all, views_, reader_.warper());
  ASSERT_EQ(kept.size(), map_.markers.size());
  for (const Marker& marker : map_.markers) {
    EXPECT_EQ(std::count_if(kept.begin(), kept.end(),
                            [&](const MarkerReading& reading) {
                              return reading.id == marker.id && error(reading, marker) < 0.3;
                            }),
              1)
        << marker.id;
  }
}

TEST_F(MarkerReaderTest, OfTwoReadingsTheOneNearerToItsViewsMiddleStays) {
  MarkerReading reading = *test::exactReading(map_.markers[0], camera_, truth_);
  const auto offMiddle = [&](std::size_t view) {
    const auto position = reader_.warper().viewFromPanorama(views_[view], reading.center);
    return position ? std::abs(position->x() - 0.5 * views_[view].size.width) : 1e9;
  };
  std::size_t nearest = 0;
  for (std::size_t v = 1; v < views_.size(); ++v) {
    if (offMiddle(v) < offMiddle(nearest)) nearest = v;
  }
  const std::size_t neighbour = (nearest + 1) % views_.size();
  for (const auto& [first, second] :
       {std::pair(nearest, neighbour), std::pair(neighbour, nearest)}) {
    std::vector<MarkerReading> readings(2, reading);
    readings[0].view = first;
    readings[1].view = second;
    readings[1].center += Eigen::Vector2d(0.2, -0.1);
    const auto kept = withoutRepetitions(readings, views_, reader_.warper());
    ASSERT_EQ(kept.size(), 1U);
    EXPECT_EQ(kept[0].view, nearest);
  }
}

TEST_F(MarkerReaderTest, OtherIdsAndFamiliesAtTheSamePlaceAreNoRepetitions) {
  std::vector<MarkerReading> readings(3, *test::exactReading(map_.markers[0], camera_, truth_));
  readings[1].id += 1;
  readings[2].family = "tag16h5";
  EXPECT_EQ(withoutRepetitions(readings, views_, reader_.warper()).size(), 3U);
  EXPECT_TRUE(withoutRepetitions({}, views_, reader_.warper()).empty());
}

TEST(MeanEdgeTest, IsTheMeanOfFourLengths) {
  EXPECT_DOUBLE_EQ(meanEdge({Eigen::Vector2d(0, 0), Eigen::Vector2d(3, 4), Eigen::Vector2d(3, 6),
                             Eigen::Vector2d(0, 10)}),
                   (5.0 + 2.0 + 5.0 + 10.0) / 4.0);
}

TEST_F(MarkerReaderTest, SeveralThreadsReadTheSame) {
  const cv::Mat panorama = test::renderPanorama(map_, camera_, truth_);
  std::vector<cv::Mat> images;
  images.reserve(views_.size());
  for (const View& view : views_) images.push_back(reader_.warper().warp(panorama, view));
  const std::vector<MarkerReading> expected = readEverywhere();
  for (const int threads : {1, 3}) {
    const MarkerReader reader(test::sphericalCamera(), kWorkingDistance, {}, {"tag36h11"}, threads);
    for (int round = 0; round < 3; ++round) {
      const std::vector<MarkerReading> readings = reader.read(images, views_);
      ASSERT_EQ(readings.size(), expected.size());
      for (std::size_t i = 0; i < readings.size(); ++i) {
        EXPECT_EQ(readings[i].id, expected[i].id);
        EXPECT_EQ(readings[i].view, expected[i].view);
        for (std::size_t k = 0; k < 4; ++k) {
          EXPECT_EQ(readings[i].corners[k], expected[i].corners[k]);
        }
      }
    }
  }
}

}  // namespace
}  // namespace omnitag
