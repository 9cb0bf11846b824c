#include "adjustment/light_grid.h"

#include <gtest/gtest.h>

namespace omnitag {
namespace {

/// Contrast with a slope and a twist, which a grid that is bilinear between its nodes represents
/// exactly.
double bilinear(const Eigen::Vector2d& place) {
  return 120.0 + 30.0 * place.x() - 12.0 * place.y() + 7.0 * place.x() * place.y();
}

GridLight gridOf(double black, double (*contrast)(const Eigen::Vector2d&)) {
  GridLight light;
  light[0] = black;
  for (Eigen::Index row = 0; row < kLightNodes; ++row) {
    for (Eigen::Index column = 0; column < kLightNodes; ++column) {
      const Eigen::Vector2d node(static_cast<double>(column), static_cast<double>(row));
      light[1 + row * kLightNodes + column] =
          contrast(node / static_cast<double>(kLightNodes - 1) - Eigen::Vector2d(0.5, 0.5));
    }
  }
  return light;
}

TEST(LightGridTest, IsBilinearBetweenItsNodesToTheBorder) {
  const GridLight light = gridOf(15.0, bilinear);
  for (const Eigen::Vector2d& place :
       {Eigen::Vector2d(-0.5, -0.5), Eigen::Vector2d(0.5, 0.5), Eigen::Vector2d(0.5, -0.5),
        Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.13, -0.37)}) {
    EXPECT_NEAR(contrastAt(place, light), bilinear(place), 1e-9);
    EXPECT_NEAR(light.dot(greyByLight(0.3, place)), 15.0 + 0.3 * bilinear(place), 1e-9);
  }
  EXPECT_NEAR(meanContrast(light), 120.0, 1e-9);
}

TEST(LightGridTest, IsRoughWhereContrastBends) {
  const auto roughnessOf = [](const GridLight& light) { return light.dot(roughness() * light); };
  const auto plane = [](const Eigen::Vector2d& place) { return 90.0 + 20.0 * place.x(); };
  EXPECT_NEAR(roughnessOf(gridOf(15.0, plane)), 0.0, 1e-9);
  // One node that stands out by 1: second differences of -2 and four of 1, twists of 1 in four
  // cells.
  GridLight peak = gridOf(15.0, plane);
  peak[1 + 2 * kLightNodes + 2] += 1.0;
  EXPECT_NEAR(roughnessOf(peak), 2 * (4.0 + 1.0 + 1.0) + 4.0, 1e-9);
}

}  // namespace
}  // namespace omnitag
