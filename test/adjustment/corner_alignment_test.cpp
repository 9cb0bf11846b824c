#include "adjustment/corner_alignment.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <random>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "../support/sweep.h"

namespace omnitag {
namespace {

class CornerAlignmentTest : public testing::Test {
 protected:
  /// The panorama with noise (grey levels).
  cv::Mat panoramaOf(const Marker& marker, double noise) const {
    constexpr int kSamples = 8;
    return withNoise(test::renderPanorama({"map", {marker}}, camera_, pose_, kSamples), noise);
  }

  static cv::Mat withNoise(cv::Mat image, double noise) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0.0, noise);
    for (int row = 0; row < image.rows; ++row) {
      for (int column = 0; column < image.cols; ++column) {
        auto& grey = image.at<std::uint8_t>(row, column);
        grey = cv::saturate_cast<std::uint8_t>(grey + normal(random));
      }
    }
    return image;
  }

  std::optional<AlignedCorners> align(const cv::Mat& panorama, const Marker& marker,
                                      const Pose& pose) const {
    return alignCorners(panorama, marker, TagPattern(marker.family, marker.id), camera_, pose);
  }

  /// The image with its light multiplied by `bright` on one side of a line through the middle of
  /// the marker's image, along `heading`, and by `dark` on the other.
  cv::Mat withShadow(const cv::Mat& image, const Marker& marker, double heading, double bright,
                     double dark) const {
    const auto corners = test::exactReading(marker, camera_, pose_)->corners;
    const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    const Eigen::Vector2d across(-std::sin(heading), std::cos(heading));
    cv::Mat lit = image.clone();
    for (int row = 0; row < lit.rows; ++row) {
      for (int column = 0; column < lit.cols; ++column) {
        auto& grey = lit.at<std::uint8_t>(row, column);
        const bool is_bright = across.dot(Eigen::Vector2d(column, row) - middle) > 0.0;
        grey = cv::saturate_cast<std::uint8_t>((is_bright ? bright : dark) * grey);
      }
    }
    return lit;
  }

  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
  Pose pose_{0.2, -0.1, 0.4};
};

TEST_F(CornerAlignmentTest, FindsTheCornersFromAPoseThatIsOff) {
  for (const Marker& marker : {test::wallMarker(3, {1.9, 0.6, 1.3}, -2.6, 0.2),
                               test::wallMarker(11, {-0.9, -1.6, 1.1}, 1.4)}) {
    const cv::Mat panorama = panoramaOf(marker, 2.0);
    const CornerPixels truth = stacked(test::exactReading(marker, camera_, pose_)->corners);
    for (const Pose& off : {pose_, Pose{pose_.x + 0.008, pose_.y - 0.005, pose_.yaw + 0.002}}) {
      const auto aligned = align(panorama, marker, off);
      ASSERT_TRUE(aligned) << marker.id;
      const CornerPixels error = aligned->pixels - truth;
      EXPECT_LT(error.norm() / std::sqrt(8.0), 0.02) << marker.id;
      // Chi-square with 8 degrees of freedom stays below 26 in 999 of 1000 cases.
      EXPECT_LT(error.dot(aligned->covariance.ldlt().solve(error)), 26.0) << marker.id;
      EXPECT_LT(std::sqrt(aligned->covariance.trace() / 8.0), 0.04) << marker.id;
    }
  }
}

TEST_F(CornerAlignmentTest, CovarianceIsThatOfTheErrors) {
  if (test::kIsSanitized) GTEST_SKIP() << test::kRepeats;
  constexpr int kPlaces = 60;
  double squares = 0.0;
  for (int i = 0; i < kPlaces; ++i) {
    const double direction = 0.37 + 0.61 * i;
    const double range = 1.6 + 0.03 * (i % 7);
    const Marker marker = test::wallMarker(
        i, {range * std::cos(direction), range * std::sin(direction), 1.1 + 0.05 * (i % 5)},
        normalizeAngle(direction + kPi + 0.5 * std::sin(2.0 * i)));
    const CornerPixels truth = stacked(test::exactReading(marker, camera_, pose_)->corners);
    const auto aligned = align(panoramaOf(marker, 4.0), marker, pose_);
    ASSERT_TRUE(aligned) << i;
    const CornerPixels error = aligned->pixels - truth;
    squares += error.dot(aligned->covariance.ldlt().solve(error));
  }
  // 1 if the covariance is exact: the mean of 480 squares is then within 20 % in 999 of 1000 cases.
  const double normalized = squares / (8.0 * kPlaces);
  EXPECT_GT(normalized, 0.5);
  EXPECT_LT(normalized, 1.3);
}

TEST_F(CornerAlignmentTest, IsNotMisledByTheEdgeOfAShadow) {
  const Marker marker = test::wallMarker(3, {1.9, 0.6, 1.3}, -2.6, 0.2);
  const CornerPixels truth = stacked(test::exactReading(marker, camera_, pose_)->corners);
  const cv::Mat even = test::renderPanorama({"map", {marker}}, camera_, pose_, 8);
  for (int i = 0; i < 12; ++i) {
    const double heading = 0.1 + 0.5 * i;
    const cv::Mat panorama = withNoise(withShadow(even, marker, heading, 1.0, 0.55), 2.0);
    const auto aligned = align(panorama, marker, pose_);
    ASSERT_TRUE(aligned) << heading;
    const CornerPixels error = aligned->pixels - truth;
    EXPECT_LT(error.norm() / std::sqrt(8.0), 0.05) << heading;
    EXPECT_LT(error.dot(aligned->covariance.ldlt().solve(error)), 26.0) << heading;
  }
}

TEST_F(CornerAlignmentTest, GetsAlongWithWhiteThatIsTooBright) {
  const Marker marker = test::wallMarker(11, {-0.9, -1.6, 1.1}, 1.4);
  const CornerPixels truth = stacked(test::exactReading(marker, camera_, pose_)->corners);
  const cv::Mat even = test::renderPanorama({"map", {marker}}, camera_, pose_, 8);
  const cv::Mat panorama = withNoise(withShadow(even, marker, 0.7, 1.5, 0.9), 2.0);
  const auto aligned = align(panorama, marker, pose_);
  ASSERT_TRUE(aligned);
  const CornerPixels error = aligned->pixels - truth;
  EXPECT_LT(error.norm() / std::sqrt(8.0), 0.04);
  EXPECT_LT(error.dot(aligned->covariance.ldlt().solve(error)), 26.0);
}

TEST_F(CornerAlignmentTest, RefusesWhatIsNotThere) {
  const Marker marker = test::wallMarker(3, {1.9, 0.6, 1.3}, -2.6);
  Marker other = marker;
  other.id = 12;
  EXPECT_FALSE(align(panoramaOf(other, 2.0), marker, pose_));
  const cv::Mat even(500, 500, CV_8UC1, cv::Scalar(120));
  EXPECT_FALSE(align(even, marker, pose_));
  Marker hidden = marker;
  hidden.map_from_marker.translation().z() = 500.0;
  EXPECT_FALSE(align(even, hidden, pose_));
}

}  // namespace
}  // namespace omnitag
