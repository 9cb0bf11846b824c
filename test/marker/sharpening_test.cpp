#include "marker/sharpening.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace omnitag {
namespace {

TEST(SharpeningTest, BringsBackModulesThatWereBlurred) {
  constexpr int kSize = 96;
  constexpr int kModule = 6;
  constexpr double kBlur = 2.0;
  cv::Mat board(kSize, kSize, CV_8UC1);
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize; ++column) {
      board.at<std::uint8_t>(row, column) = (row / kModule + column / kModule) % 2 == 0 ? 60 : 180;
    }
  }
  cv::Mat blurred;
  cv::GaussianBlur(board, blurred, {}, kBlur);
  const cv::Mat sharp = sharpened(blurred, kBlur);
  const auto contrastIn = [](const cv::Mat& image) {
    // Between the middles of two neighbouring modules.
    constexpr int kMiddle = kSize / 2 + kModule / 2;
    return std::abs(image.at<std::uint8_t>(kMiddle, kMiddle) -
                    image.at<std::uint8_t>(kMiddle, kMiddle + kModule));
  };
  EXPECT_LT(contrastIn(blurred), 70);
  EXPECT_GT(contrastIn(sharp), 1.7 * contrastIn(blurred));
}

TEST(SharpeningTest, LeavesASharpImageAlone) {
  const cv::Mat image(10, 10, CV_8UC1, cv::Scalar(7));
  EXPECT_EQ(sharpened(image, 0.5).data, image.data);
}

}  // namespace
}  // namespace omnitag
