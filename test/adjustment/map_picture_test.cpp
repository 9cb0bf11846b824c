#include "adjustment/map_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <opencv2/core.hpp>

#include "../support/sample_markers.h"
#include "adjustment/error_ellipse.h"

namespace omnitag {
namespace {

TEST(ErrorEllipseTest, HasTheDeviationsAsHalfAxes) {
  const Eigen::Rotation2Dd turn(radians(30.0));
  const Eigen::Vector2d variances(9e-6, 1e-6);
  const Eigen::Matrix2d covariance =
      turn.toRotationMatrix() * variances.asDiagonal() * turn.toRotationMatrix().transpose();
  const ErrorEllipse ellipse = errorEllipse(covariance);
  EXPECT_NEAR(ellipse.major, 0.003, 1e-9);
  EXPECT_NEAR(ellipse.minor, 0.001, 1e-9);
  EXPECT_NEAR(ellipse.direction, radians(30.0), 1e-6);
  const Eigen::Vector2d centre(1.0, 2.0);
  // On the ellipse, errors are one standard deviation.
  for (const double angle : {0.0, 1.0, 2.5}) {
    const Eigen::Vector2d error = ellipse.point(centre, angle) - centre;
    EXPECT_NEAR(error.dot(covariance.inverse() * error), 1.0, 1e-6);
  }
}

TEST(ErrorEllipseTest, IsMagnifiedAsFarAsThereIsRoom) {
  EXPECT_EQ(magnificationFor(0.005, 0.7), 100);
  EXPECT_EQ(magnificationFor(0.02, 0.7), 20);
  EXPECT_EQ(magnificationFor(0.00003, 0.7), 1000);
  EXPECT_EQ(magnificationFor(2.0, 0.7), 1);
}

/// The smallest rectangle that holds all pixels for which this is true.
cv::Rect boundsOf(const cv::Mat& picture, const std::function<bool(const cv::Vec3b&)>& isMeant) {
  cv::Rect bounds;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      if (!isMeant(picture.at<cv::Vec3b>(y, x))) continue;
      const cv::Rect pixel(x, y, 1, 1);
      bounds = bounds.empty() ? pixel : bounds | pixel;
    }
  }
  return bounds;
}

/// A sheet of 10 x 10 m about the origin, 110 pixels per metre, and in its middle a marker on the
/// floor whose place is known to 2 mm in x and 5 mm in y.
BuiltMap sampleMap() {
  BuiltMap map;
  for (const double corner : {-4.3, 4.3}) {
    BuiltMarker exact;
    exact.marker = test::lyingMarker(1, {corner, corner, 0.0}, true, 0.0, 0.1);
    exact.is_seed = exact.is_exact = true;
    map.markers.push_back(exact);
  }
  BuiltMarker found;
  found.marker = test::lyingMarker(2, {0.0, 0.0, 0.0}, true, 0.0, 0.02);
  found.covariance(0, 0) = 4e-6;
  found.covariance(1, 1) = 25e-6;
  map.markers.push_back(found);
  return map;
}

/// The sheet without its legend.
cv::Mat sheetOf(const BuiltMap& map) { return mapPicture(map)(cv::Rect(0, 0, 1090, 1090)); }

TEST(MapPictureTest, DrawsAHundredDeviations) {
  const cv::Mat sheet = sheetOf(sampleMap());
  ASSERT_EQ(sheet.type(), CV_8UC3);
  const cv::Rect ellipse =
      boundsOf(sheet, [](const cv::Vec3b& colour) { return colour == cv::Vec3b(230, 190, 150); });
  EXPECT_NEAR(ellipse.width, 2 * 22, 3);
  EXPECT_NEAR(ellipse.height, 2 * 55, 3);
  EXPECT_NEAR(ellipse.x + 0.5 * ellipse.width, 550, 2);
  EXPECT_NEAR(ellipse.y + 0.5 * ellipse.height, 550, 2);
}

/// Where the drawing changes if the seed had the marker there (m), known to 5 mm.
cv::Rect boundsOfBefore(const Eigen::Vector3d& place) {
  BuiltMap map = sampleMap();
  const cv::Mat without = sheetOf(map).clone();
  Marker before = map.markers.back().marker;
  before.map_from_marker.translation() = place;
  before.deviation = 0.005;
  map.markers.back().is_seed = true;
  map.markers.back().survey = PlacePrior::surveyed(before);
  cv::Mat difference;
  cv::absdiff(sheetOf(map), without, difference);
  return boundsOf(difference, [](const cv::Vec3b& colour) { return colour != cv::Vec3b(0, 0, 0); });
}

TEST(MapPictureTest, DrawsTheSeedsDeviationsAboutItsPlace) {
  // Magnified, the place is 0.3 m to the right, and 5 mm become 0.5 m.
  const cv::Rect before = boundsOfBefore({0.003, 0.0, 0.0});
  EXPECT_NEAR(before.x, 550 + 33 - 55, 2);
  EXPECT_NEAR(before.x + before.width, 550 + 33 + 55, 3);
  EXPECT_NEAR(before.y, 550 - 55, 2);
  EXPECT_NEAR(before.y + before.height, 550 + 55, 3);
}

TEST(MapPictureTest, DrawsASeedsPlaceThatIsFarAwayAsItIs) {
  // The outline of 2 cm is 2 pixels wide.
  const cv::Rect before = boundsOfBefore({1.0, 0.0, 0.0});
  EXPECT_NEAR(before.x + before.width, 660 + 2, 3);
  EXPECT_LT(before.height, 10);
}

}  // namespace
}  // namespace omnitag
