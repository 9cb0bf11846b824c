#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "camera/mounted_camera.h"
#include "omnitag/common/angle.h"
#include "sample_cameras.h"

namespace omnitag {
namespace {

class TabulatedRayTest : public testing::TestWithParam<SampleCamera> {
 protected:
  const CatadioptricCamera& camera() const { return GetParam().camera; }

  Eigen::Vector2d pixelAt(double radius, double azimuth) const {
    return camera().imagePlane().pixelFromIdeal(
        radius * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth)));
  }

  /// Calls back with pixel positions all over the ring that shows the world, finer than the table.
  template <typename Visit>
  void forRing(const Visit& visit) const {
    const double low = camera().minRadius();
    const double high = camera().maxRadius();
    constexpr int kRadii = 3001;
    for (int i = 0; i < kRadii; ++i) {
      // The golden angle spreads the azimuths evenly.
      const Eigen::Vector2d pixel =
          pixelAt(low + (high - low) * (i + 0.5) / kRadii, i * kPi * (3.0 - std::sqrt(5.0)));
      if (camera().isInImage(pixel)) visit(pixel);
    }
  }
};

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST_P(TabulatedRayTest, IsOffByLessThanAThousandthOfAPixelWhereRaysTurnEvenly) {
  double largest = 0.0;
  double largest_where_even = 0.0;
  double largest_shift = 0.0;
  int even = 0;
  int count = 0;
  forRing([&](const Eigen::Vector2d& pixel) {
    const auto exact = camera().rayFromPixel(pixel);
    const auto tabulated = camera().tabulatedRayFromPixel(pixel);
    ASSERT_TRUE(exact && tabulated) << pixel.transpose();
    EXPECT_NEAR(tabulated->direction.norm(), 1.0, 2e-3);
    const Eigen::Vector2d outward = (pixel - camera().imagePlane().principalPoint()).normalized();
    const auto inner = camera().rayFromPixel(pixel - outward);
    const auto outer = camera().rayFromPixel(pixel + outward);
    if (!inner || !outer) return;
    ++count;
    const double before = angleBetween(inner->direction, exact->direction);
    const double after = angleBetween(exact->direction, outer->direction);
    const double per_pixel = 0.5 * (before + after);
    const double error = angleBetween(exact->direction, tabulated->direction) / per_pixel;
    largest = std::max(largest, error);
    if (std::abs(after - before) < 0.03 * per_pixel) {
      ++even;
      largest_where_even = std::max(largest_where_even, error);
    }
    // The ray's origin matters only as far as it shifts the ray sideways.
    constexpr double kNear = 1.0;  // m
    const Eigen::Vector3d shift = tabulated->origin - exact->origin;
    largest_shift =
        std::max(largest_shift, shift.cross(exact->direction).norm() / (kNear * per_pixel));
  });
  ASSERT_GT(count, 1000);
  RecordProperty("largest_error_pixels", std::to_string(largest));
  RecordProperty("largest_error_where_even_pixels", std::to_string(largest_where_even));
  RecordProperty("largest_shift_pixels", std::to_string(largest_shift));
  EXPECT_LT(largest_where_even, 1e-3);
  EXPECT_LT(largest_shift, 1e-3);
  // Toward a ball's silhouette rays turn ever faster.
  EXPECT_LT(largest, GetParam().name == "Ball" ? 0.02 : 0.004);
  EXPECT_GT(even, 0.9 * count);
}

TEST_P(TabulatedRayTest, SeesWhatTheExactRaySees) {
  const double low = camera().minRadius();
  const double high = camera().maxRadius();
  for (const double radius : {low - 0.01 * high, low + 1e-9 * high, 0.5 * (low + high),
                              high * (1.0 - 1e-9), 1.01 * high}) {
    if (radius < 0.0) continue;
    for (int i = 0; i < 12; ++i) {
      const Eigen::Vector2d pixel = pixelAt(radius, 0.1 + i * kPi / 6.0);
      EXPECT_EQ(camera().tabulatedRayFromPixel(pixel).has_value(),
                camera().rayFromPixel(pixel).has_value())
          << pixel.transpose();
    }
  }
  EXPECT_FALSE(camera().tabulatedRayFromPixel({-0.6, 10.0}));
  EXPECT_FALSE(
      camera().tabulatedRayFromPixel({10.0, static_cast<double>(camera().imageSize().height)}));
}

TEST_P(TabulatedRayTest, InTheRobotsFrameItIsMountedAsTheExactOne) {
  const Eigen::Isometry3d mounting = Eigen::Translation3d(0.1, -0.05, 1.1) *
                                     Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()) *
                                     Eigen::AngleAxisd(3.1, Eigen::Vector3d::UnitX());
  const MountedCamera mounted(std::make_shared<CatadioptricCamera>(camera()), mounting);
  const Eigen::Vector2d pixel =
      pixelAt(0.3 * camera().minRadius() + 0.7 * camera().maxRadius(), 0.8);
  const auto exact = mounted.rayInBase(pixel);
  const auto tabulated = mounted.tabulatedRayInBase(pixel);
  ASSERT_TRUE(exact && tabulated);
  EXPECT_LT((tabulated->origin - exact->origin).norm(), 1e-5);
  EXPECT_LT(angleBetween(exact->direction, tabulated->direction), 1e-5);
  EXPECT_FALSE(mounted.tabulatedRayInBase({-3.0, 0.0}));
}

INSTANTIATE_TEST_SUITE_P(Cameras, TabulatedRayTest, testing::ValuesIn(sampleCameras()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace omnitag
