#include "adjustment/image_residuals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

namespace omnitag {
namespace {

CornerResidual corner(std::size_t frame, std::optional<Eigen::Vector2d> residual) {
  return {frame, 0, {100.0, 100.0}, residual};
}

TEST(ImageResidualsTest, AreTheRmsOfEachImage) {
  const std::vector<CornerResidual> corners = {
      corner(0, Eigen::Vector2d(0.3, 0.4)), corner(2, Eigen::Vector2d(5.0, 0.0)),
      corner(0, Eigen::Vector2d(0.0, 0.1)), corner(2, std::nullopt),
      corner(2, Eigen::Vector2d(0.0, -0.1))};
  const auto images = imageResiduals(corners, {10.0, 10.5, 11.0});
  ASSERT_EQ(images.size(), 3U);
  EXPECT_EQ(images[0].stamp, 10.0);
  EXPECT_EQ(images[2].stamp, 11.0);
  EXPECT_NEAR(images[0].rms, std::sqrt((0.25 + 0.01) / 2.0), 1e-12);
  EXPECT_EQ(images[0].used, 2U);
  EXPECT_EQ(images[1].used + images[1].left_out, 0U);
  EXPECT_EQ(images[1].rms, 0.0);
  // Eight times the median is 4 pixels here; one corner is beyond, one is hidden.
  EXPECT_NEAR(images[2].rms, 0.1, 1e-12);
  EXPECT_EQ(images[2].used, 1U);
  EXPECT_EQ(images[2].left_out, 2U);
}

TEST(ImageResidualsTest, NamesThoseThatStandOut) {
  const std::vector<ImageResidual> images = {
      {0.0, 0.10, 8, 0}, {1.0, 0.11, 8, 0}, {2.0, 0.09, 8, 0}, {3.0, 0.25, 8, 0},
      {4.0, 0.40, 8, 3}, {5.0, 0.10, 1, 3}, {6.0, 0.00, 0, 0}, {7.0, 0.19, 8, 0}};
  EXPECT_NEAR(medianRms(images), 0.11, 0.011);
  EXPECT_EQ(outstandingImages(images), (std::vector<std::size_t>{5, 4, 3}));
  EXPECT_TRUE(outstandingImages({}).empty());
  EXPECT_EQ(medianRms({}), 0.0);
}

}  // namespace
}  // namespace omnitag
