#include "camera/equirectangular_camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

constexpr ImageSize kSize{720, 360};

/// As the camera file's format says.
Eigen::Vector3d directionOf(const Eigen::Vector2d& pixel, const ImageSize& size) {
  const double longitude = 2.0 * kPi * (pixel.x() + 0.5) / size.width - kPi;
  const double latitude = 0.5 * kPi - kPi * (pixel.y() + 0.5) / size.height;
  return {std::cos(latitude) * std::sin(longitude), -std::sin(latitude),
          std::cos(latitude) * std::cos(longitude)};
}

template <typename Check>
void forEachPixel(const ImageSize& size, double step, Check check) {
  for (double v = -0.45; v < size.height - 0.5; v += step) {
    for (double u = -0.45; u < size.width - 0.5; u += step) check(Eigen::Vector2d(u, v));
  }
}

TEST(Equirectangular, looksAllAround) {
  for (const ImageSize& size : {kSize, ImageSize{501, 400}}) {
    const EquirectangularCamera camera(size);
    forEachPixel(size, 1.9, [&](const Eigen::Vector2d& pixel) {
      const Eigen::Vector3d direction = directionOf(pixel, size);
      const auto ray = camera.rayFromPixel(pixel);
      ASSERT_TRUE(ray) << pixel.transpose();
      ASSERT_LT(ray->origin.norm(), 1e-15);
      ASSERT_LT((ray->direction - direction).norm(), 1e-12) << pixel.transpose();
      const auto tabulated = camera.tabulatedRayFromPixel(pixel);
      ASSERT_TRUE(tabulated);
      ASSERT_LT((tabulated->direction - direction).norm(), 1e-5);
      const auto again = camera.pixelFromPoint(2.5 * direction);
      ASSERT_TRUE(again) << pixel.transpose();
      ASSERT_LT((*again - pixel).norm(), 1e-8) << pixel.transpose();
    });
  }
}

TEST(Equirectangular, namesItsAxes) {
  // Ahead is the middle, x to the right of it, y below.
  const EquirectangularCamera camera(kSize);
  const auto at = [&](double x, double y, double z) { return *camera.pixelFromPoint({x, y, z}); };
  EXPECT_LT((at(0, 0, 1) - Eigen::Vector2d(359.5, 179.5)).norm(), 1e-9);
  EXPECT_LT((at(1, 0, 0) - Eigen::Vector2d(539.5, 179.5)).norm(), 1e-9);
  EXPECT_LT((at(-1, 0, 0) - Eigen::Vector2d(179.5, 179.5)).norm(), 1e-9);
  EXPECT_LT((at(0, 1, 1) - Eigen::Vector2d(359.5, 269.5)).norm(), 1e-9);
  EXPECT_LT((at(1e-3, 0, -1) - Eigen::Vector2d(719.5, 179.5)).norm(), 0.2);
  EXPECT_LT((at(-1e-3, 0, -1) - Eigen::Vector2d(-0.5, 179.5)).norm(), 0.2);
  EXPECT_FALSE(camera.pixelFromPoint({0, 0, -1}));
  EXPECT_FALSE(camera.pixelFromPoint({0, 0, 0}));
}

TEST(Equirectangular, hasTheDerivativesOfItsProjection) {
  const EquirectangularCamera camera(kSize);
  int compared = 0;
  forEachPixel(kSize, 17.3, [&](const Eigen::Vector2d& pixel) {
    // Not across the seam, nor near a pole, where a longitude says little.
    const bool is_near_seam = pixel.x() < 2.0 || pixel.x() > kSize.width - 3.0;
    if (is_near_seam || pixel.y() < 10.0 || pixel.y() > kSize.height - 11.0) return;
    for (const double range : {0.1, 3.0}) {
      const Eigen::Vector3d point = range * directionOf(pixel, kSize);
      Eigen::Matrix<double, 2, 3> jacobian;
      ASSERT_TRUE(camera.pixelFromPoint(point, &jacobian));
      Eigen::Matrix<double, 2, 3> numeric;
      const double step = 1e-5 * range;
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d offset = step * Eigen::Vector3d::Unit(axis);
        numeric.col(axis) =
            (*camera.pixelFromPoint(point + offset) - *camera.pixelFromPoint(point - offset)) /
            (2.0 * step);
      }
      ASSERT_LT((jacobian - numeric).norm(), 1e-6 * jacobian.norm()) << pixel.transpose();
      ++compared;
    }
  });
  EXPECT_GT(compared, 1000);
}

TEST(Equirectangular, seesNothingWhereNothingIsNumber) {
  const EquirectangularCamera camera(kSize);
  EXPECT_FALSE(camera.pixelFromPoint({NAN, 1.0, 0.0}));
  EXPECT_FALSE(camera.pixelFromPoint({1.0, 1.0, INFINITY}));
  EXPECT_FALSE(camera.rayFromPixel({NAN, 3.0}));
  EXPECT_FALSE(camera.rayFromPixel({-0.51, 3.0}));
}

}  // namespace
}  // namespace omnitag
