#include "../../benchmark/room_renderer.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"

namespace omnitag::test {
namespace {

const Pose kPose{0.4, -0.3, 0.7};

MarkerMap markerMap() {
  MarkerMap map;
  map.markers = roomMarkers();
  return map;
}

class RoomRendererTest : public testing::Test {
 protected:
  cv::Mat render(const MarkerMap& map, const std::vector<Wall>& walls) const {
    return RoomRenderer(camera_).render(map, TagPatterns(map), walls, kPose);
  }

  MountedCamera camera_{sphericalCamera(), lookingDown()};
};

TEST_F(RoomRendererTest, DrawsMarkersAsLinesOfSightShowThem) {
  const MarkerMap map = markerMap();
  const cv::Mat expected = renderPanorama(map, camera_, kPose, 8);
  cv::Mat difference;
  cv::absdiff(render(map, {}), expected, difference);
  // The other renderer also takes the mean of the samples of pixels at the rim.
  cv::Mat field;
  cv::erode(render({}, {}), field, cv::Mat());
  difference.setTo(0, field == 0);
  // Where a sample falls on the other side of an edge, a pixel is a little off.
  EXPECT_LE(cv::norm(difference, cv::NORM_INF), 190.0 / 9.0 + 1.0);
  EXPECT_LT(cv::mean(difference)[0], 0.003);
  EXPECT_GT(cv::countNonZero(expected > 200), 500);
}

TEST_F(RoomRendererTest, HidesMarkersBehindWalls) {
  MarkerMap map = markerMap();
  const Wall wall{{3.5, -5.0}, {3.5, 5.0}};
  const cv::Mat hidden = render(map, {wall});
  map.markers.erase(map.markers.begin(), map.markers.begin() + 3);  // those behind it
  const cv::Mat without = render(map, {wall});
  EXPECT_EQ(cv::norm(hidden, without, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(hidden, render(markerMap(), {}), cv::NORM_INF), 50.0);
}

TEST(WithGreyNoise, AddsAsMuchAsItIsTold) {
  const cv::Mat even(200, 200, CV_8UC1, cv::Scalar(120.0));
  const cv::Mat noisy = withGreyNoise(even, 2.0, 7);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(noisy, mean, deviation);
  EXPECT_NEAR(mean[0], 120.0, 0.05);
  // Rounding adds a twelfth to the variance.
  EXPECT_NEAR(deviation[0] * deviation[0], 4.0 + 1.0 / 12.0, 0.15);
  EXPECT_EQ(cv::norm(noisy, withGreyNoise(even, 2.0, 7), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(noisy, withGreyNoise(even, 2.0, 8), cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace omnitag::test
