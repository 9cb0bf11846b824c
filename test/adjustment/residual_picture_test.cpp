#include "adjustment/residual_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

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

/// The same corner, off by this many pixels to the right, in the image at 10 s.
PicturedResiduals cornerOff(double pixels) {
  PicturedResiduals residuals;
  residuals.corners = {{0, 0, {250.0, 250.0}, Eigen::Vector2d(pixels, 0.0)}};
  residuals.stamps = {10.0};
  return residuals;
}

TEST(ResidualPictureTest, DrawsAnArrowWhereItWasMeasured) {
  const auto camera = test::sphericalCamera();
  const cv::Mat image(500, 500, CV_8UC1, cv::Scalar(90));
  const cv::Mat empty = residualPicture({}, *camera, image);
  const cv::Mat still = residualPicture(cornerOff(0.0), *camera, image);
  const cv::Mat picture = residualPicture(cornerOff(0.3), *camera, image);
  ASSERT_EQ(picture.type(), CV_8UC3);
  ASSERT_EQ(picture.size(), empty.size());
  cv::Mat difference;
  cv::absdiff(picture, still, difference);
  // 1.8 pixels of the picture per pixel, below the header.
  const cv::Rect place(440, 512, 90, 40);
  EXPECT_EQ(coloured(empty, place), 0);
  EXPECT_GT(coloured(picture, place), 40);
  EXPECT_EQ(cv::countNonZero(difference(cv::Rect(0, 100, 400, 700)).reshape(1)), 0);
}

TEST(ResidualPictureTest, TintsWhereNoCornerWasSeen) {
  const auto camera = test::sphericalCamera();
  const cv::Mat image(500, 500, CV_8UC1, cv::Scalar(90));
  const Eigen::Vector2d centre = camera->imagePlane().principalPoint();
  const double outer = camera->rimPixels();
  const double inner = camera->imagePlane().scale() * camera->minRadius();
  const double middle = std::sqrt(0.5 * (outer * outer + inner * inner));
  const auto out = [&](double azimuth) {
    return Eigen::Vector2d(centre + middle * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth)));
  };
  PicturedResiduals residuals;
  residuals.corners = {{0, 0, out(0.0), Eigen::Vector2d(0.0, 0.0)}};
  residuals.stamps = {10.0};
  const cv::Mat picture = residualPicture(residuals, *camera, image);
  // How much redder than blue the picture is at a pixel of the image.
  const auto tintAt = [&picture](const Eigen::Vector2d& pixel) {
    const auto& colour =
        picture.at<cv::Vec3b>(82 + cvRound(1.8 * pixel.y()), cvRound(1.8 * pixel.x()));
    return colour[2] - colour[0];
  };
  EXPECT_EQ(tintAt(out(radians(10.0))), 0);
  for (const double azimuth : {radians(45.0), radians(180.0), radians(-90.0)}) {
    EXPECT_GT(tintAt(out(azimuth)), 30);
  }
  EXPECT_EQ(tintAt({5.0, 5.0}), 0) << "beyond the field";
}

TEST(ResidualPictureTest, MarksAnImageThatStandsOutInTime) {
  const auto camera = test::sphericalCamera();
  const cv::Mat image(500, 500, CV_8UC1, cv::Scalar(90));
  PicturedResiduals residuals;
  for (std::size_t i = 0; i < 10; ++i) {
    residuals.stamps.push_back(100.0 + static_cast<double>(i));
    residuals.corners.push_back({i, 0, {300.0, 300.0}, Eigen::Vector2d(0.1, 0.0)});
  }
  const cv::Mat even = residualPicture(residuals, *camera, image);
  residuals.corners[3].residual = Eigen::Vector2d(0.4, 0.0);
  const cv::Mat uneven = residualPicture(residuals, *camera, image);
  // The lowest 280 rows, without what is written above the chart.
  const cv::Rect chart(0, uneven.rows - 280 + 65, uneven.cols, 280 - 65);
  const auto red = [&chart](const cv::Mat& picture, std::vector<int>* columns) {
    const cv::Mat part = picture(chart);
    for (int y = 0; y < part.rows; ++y) {
      for (int x = 0; x < part.cols; ++x) {
        const auto& colour = part.at<cv::Vec3b>(y, x);
        if (colour[2] > colour[0] + 100 && colour[2] > colour[1] + 100) columns->push_back(x);
      }
    }
  };
  std::vector<int> none;
  red(even, &none);
  EXPECT_TRUE(none.empty());
  std::vector<int> some;
  red(uneven, &some);
  ASSERT_FALSE(some.empty());
  // At 3 of 9 s: the axis reaches from column 60 to 20 before the right edge.
  const double there = 60.0 + (uneven.cols - 80.0) * 3.0 / 9.0;
  EXPECT_NEAR(*std::min_element(some.begin(), some.end()), there, 5.0);
}

}  // namespace
}  // namespace omnitag
