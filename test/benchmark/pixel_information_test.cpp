#include "../../benchmark/pixel_information.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"

namespace omnitag {
namespace {

PatternPixel pixelAt(const Eigen::Vector2d& offset, double white,
                     const Eigen::Vector3d& white_by_pose) {
  PatternPixel pixel;
  pixel.white = white;
  pixel.white_by_pose = white_by_pose;
  pixel.offset = offset;
  return pixel;
}

/// Even pixels, and edges that move in opposite directions, as those of a stripe do.
std::vector<PatternPixel> stripe() {
  std::vector<PatternPixel> pixels;
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      pixels.push_back(pixelAt({x, y}, 0.0, Eigen::Vector3d::Zero()));
      pixels.push_back(pixelAt({x, y}, 1.0, Eigen::Vector3d::Zero()));
      pixels.push_back(pixelAt({x, y}, 0.5, {3.0, 0.0, 0.0}));
      pixels.push_back(pixelAt({x, y}, 0.5, {-3.0, 0.0, 0.0}));
    }
  }
  return pixels;
}

TEST(PixelInformation, OfEdgesIsTheirContrastOverTheNoise) {
  const Eigen::Matrix3d information = pixelInformation(stripe(), 100.0, 2.0, 0.0).matrix;
  // 18 pixels that change by 300 grey levels per metre, at a noise of 2.
  EXPECT_NEAR(information(0, 0), 18.0 * 300.0 * 300.0 / 4.0, 1e-6);
  EXPECT_NEAR(information(1, 1), 0.0, 1e-9);
}

TEST(PixelInformation, IsLessWhereEdgesAreNoisier) {
  const Eigen::Matrix3d information = pixelInformation(stripe(), 100.0, 2.0, 0.0009).matrix;
  // 3 grey levels more of 100.
  EXPECT_NEAR(information(0, 0), 18.0 * 300.0 * 300.0 / (4.0 + 9.0), 1e-6);
}

TEST(PixelInformation, StepsToTheMostLikelyPose) {
  std::vector<PatternPixel> pixels = stripe();
  constexpr double kStep = 0.01;
  for (PatternPixel& pixel : pixels) {
    pixel.grey = 20.0 + 100.0 * (pixel.white + kStep * pixel.white_by_pose.x()) +
                 7.0 * pixel.white * pixel.offset.y();
  }
  const PixelInformation information = pixelInformation(pixels, 100.0, 2.0, 0.0);
  EXPECT_NEAR(information.times_step.x() / information.matrix(0, 0), kStep, 1e-9);
}

TEST(PixelInformation, IsNoneWhereLightWouldLookTheSame) {
  std::vector<PatternPixel> pixels;
  for (int i = 0; i <= 20; ++i) {
    const double white = 0.05 * i;
    const Eigen::Vector2d offset(std::cos(i), std::sin(i));
    pixels.push_back(pixelAt(offset, white, {white, 1.0 - white, white * offset.y()}));
  }
  EXPECT_LT(pixelInformation(pixels, 100.0, 2.0, 0.0).matrix.norm(), 1e-6);
}

/// A marker before a spherical mirror.
class PatternPixelsTest : public testing::Test {
 protected:
  PatternPixelsTest() {
    Marker marker;
    marker.family = "tag36h11";
    marker.id = 5;
    marker.size = 0.8;
    // Turned in its plane, so that its edges run across the pixels at all places.
    marker.map_from_marker =
        Eigen::Translation3d(3.0, 0.5, 1.3) * uprightOrientation(kPi - 0.4, 0.3);
    map_.markers.push_back(marker);
  }

  cv::Mat render(const Pose& map_from_base) const {
    constexpr int kSamples = 24;
    return test::renderPanorama(map_, camera_, map_from_base, kSamples);
  }

  std::vector<PatternPixel> pixelsOf(const cv::Mat& image) const {
    const Marker& marker = map_.markers.front();
    return patternPixels(image, camera_, kPose, marker, TagPattern(marker.family, marker.id), 4);
  }

  static constexpr Pose kPose{0.1, -0.2, 0.3};
  MarkerMap map_;
  MountedCamera camera_{test::sphericalCamera(), test::lookingDown()};
};

TEST_F(PatternPixelsTest, HaveTheGreysOfARenderedImage) {
  const std::vector<PatternPixel> pixels = pixelsOf(render(kPose));
  ASSERT_GT(pixels.size(), 200U);
  const Light light = fitLight(pixels, 0.0);
  EXPECT_GT(light.contrast, 50.0);
  for (const PatternPixel& pixel : pixels) {
    // The renderer's 24 by 24 samples: an edge along their rows is up to 1/48 off.
    EXPECT_NEAR(light.black + light.contrast * pixel.white, pixel.grey, 0.045 * light.contrast);
    if (pixel.white > 0.1 && pixel.white < 0.9) {
      EXPECT_GT(pixel.white_by_pose.norm(), 0.0);
    }
  }
}

TEST_F(PatternPixelsTest, ChangeAsRenderedImagesDo) {
  // About a fifth of a pixel from one to the other.
  const std::vector<Pose> steps{{0.002, 0.0, 0.0}, {0.0, 0.002, 0.0}, {0.0, 0.0, 0.0007}};
  const Light light = fitLight(pixelsOf(render(kPose)), 0.0);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Pose& step = steps[i];
    const double length = step.x + step.y + step.yaw;
    const auto after = pixelsOf(render({kPose.x + step.x, kPose.y + step.y, kPose.yaw + step.yaw}));
    const auto before =
        pixelsOf(render({kPose.x - step.x, kPose.y - step.y, kPose.yaw - step.yaw}));
    double expected = 0.0;
    double actual = 0.0;
    double both = 0.0;
    for (std::size_t p = 0; p < after.size(); ++p) {
      // Even pixels may lie at the drawing's border, beyond which the background begins.
      if (after[p].white_by_pose.isZero()) continue;
      const double rendered = (after[p].grey - before[p].grey) / (2.0 * length * light.contrast);
      const double swept = after[p].white_by_pose[static_cast<Eigen::Index>(i)];
      expected += rendered * rendered;
      actual += swept * swept;
      both += rendered * swept;
    }
    // Over a step of s pixels an edge's change is spread out: the product of both loses s / 4.
    EXPECT_GT(both / actual, 0.93) << i;
    EXPECT_LT(both / actual, 1.01) << i;
    EXPECT_GT(both / std::sqrt(expected * actual), 0.98) << i;
  }
}

}  // namespace
}  // namespace omnitag
