#include "adjustment/residual_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "../support/sample_cameras.h"

namespace omnitag {
namespace {

/// Number of coloured pixels in a part of the picture.
int coloured(const cv::Mat& picture, const cv::Rect& part) {
  int count = 0;
  const cv::Mat image = picture(part);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const auto& colour = image.at<cv::Vec3b>(y, x);
      const auto [low, high] = std::minmax({colour[0], colour[1], colour[2]});
      count += high - low > 60 ? 1 : 0;
    }
  }
  return count;
}

TEST(ResidualPictureTest, DrawsAnArrowWhereItWasMeasured) {
  const auto camera = test::sphericalCamera();
  const cv::Mat image(500, 500, CV_8UC1, cv::Scalar(90));
  CalibrationResult result;
  result.noise = 0.05;
  const cv::Mat empty = residualPicture(result, *camera, image);
  // A residual of 0.3 pixels to the right, at the image's middle.
  result.residuals.push_back({0, 0, {250.0, 250.0}, Eigen::Vector2d(0.3, 0.0)});
  const cv::Mat picture = residualPicture(result, *camera, image);
  ASSERT_EQ(picture.type(), CV_8UC3);
  ASSERT_EQ(picture.size(), empty.size());
  cv::Mat difference;
  cv::absdiff(picture, empty, difference);
  const int left = 440;
  const int top = 490;
  const cv::Rect place(left, top, 90, 40);
  EXPECT_EQ(coloured(empty, place), 0);
  EXPECT_GT(coloured(picture, place), 40);
  EXPECT_EQ(cv::countNonZero(difference(cv::Rect(0, 100, 400, 700)).reshape(1)), 0);
}

}  // namespace
}  // namespace omnitag
