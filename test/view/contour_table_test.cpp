#include "view/contour_table.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "../support/sample_cameras.h"

namespace omnitag {
namespace {

/// Largest errors, in pixels of the panorama, against the exact projection of lines at a distance.
struct Errors {
  double image_radius = 0.0;  // E
  double radius = 0.0;        // F^-1
  double radius_main = 0.0;   // F
  int points = 0;
};

/// At its rim a sphere is seen at grazing incidence, where everything changes steeply; the errors
/// stated here hold up to this many pixels before it.
constexpr double kRim = 5.0;

Errors errorsAt(const CameraModel& camera, const ContourTable& table, double distance,
                double rim = kRim) {
  const double scale = camera.imagePlane().scale();
  Errors errors;
  const double first = std::max(camera.minRadius(), 20.0 / scale);
  for (double radius = first; radius < camera.maxRadius() - rim / scale; radius += 0.37 / scale) {
    const double height = camera.rayFromRadius(radius)->heightAt(distance);
    if (std::abs(height) > 3.0 * distance) continue;
    const auto worse = [scale](double* error, double a, double b) {
      *error = std::max(*error, scale * std::abs(a - b));
    };
    worse(&errors.image_radius, table.imageRadius(distance, height), radius);
    for (const double offset : {-0.5, -0.2, 0.1, 0.3, 0.5}) {
      const auto exact = camera.imageFromPoint(distance / std::cos(offset), height);
      if (!exact) continue;
      worse(&errors.radius, table.radius(radius, offset), exact->radius);
      const double main = table.radiusMain(exact->radius, offset);
      if (!std::isnan(main)) worse(&errors.radius_main, main, radius);
      ++errors.points;
    }
  }
  return errors;
}

class ContourTableTest : public testing::TestWithParam<std::shared_ptr<const CameraModel>> {};

TEST_P(ContourTableTest, IsExactToAHundredthOfAPixelAtItsDistance) {
  const ContourTable table(*GetParam(), 3.0);
  const Errors errors = errorsAt(*GetParam(), table, 3.0);
  EXPECT_GT(errors.points, 1000);
  EXPECT_LT(errors.image_radius, 0.01);
  EXPECT_LT(errors.radius, 0.01);
  EXPECT_LT(errors.radius_main, 0.02);
}

TEST_P(ContourTableTest, ImageRadiusHoldsAtAnyDistance) {
  const ContourTable table(*GetParam(), 3.0);
  for (const double distance : {0.3, 1.0, 10.0, 100.0}) {
    EXPECT_LT(errorsAt(*GetParam(), table, distance).image_radius, 0.01) << distance << " m";
  }
}

TEST_P(ContourTableTest, StaysWithinATenthOfAPixelUpToTheRim) {
  const ContourTable table(*GetParam(), 3.0);
  EXPECT_LT(errorsAt(*GetParam(), table, 3.0, 0.0).image_radius, 0.1);
}

TEST_P(ContourTableTest, ContoursOfOtherDistancesStayWithinTheDocumentedError) {
  const ContourTable table(*GetParam(), 3.0);
  EXPECT_LT(errorsAt(*GetParam(), table, 1.0).radius, 0.06);
  EXPECT_LT(errorsAt(*GetParam(), table, 10.0).radius, 0.03);
  EXPECT_LT(errorsAt(*GetParam(), table, 0.3).radius, 0.3);
}

TEST_P(ContourTableTest, HeightInvertsImageRadius) {
  const CameraModel& camera = *GetParam();
  const ContourTable table(camera, 3.0);
  for (double height = -2.0; height <= 2.0; height += 0.1) {
    const double radius = table.imageRadius(4.0, height);
    if (std::isnan(radius)) continue;
    EXPECT_NEAR(table.height(radius, 4.0), height, 1e-9);
  }
}

TEST_P(ContourTableTest, KnowsWhereItEnds) {
  const CameraModel& camera = *GetParam();
  const ContourTable table(camera, 3.0);
  EXPECT_TRUE(std::isnan(table.radius(camera.maxRadius() * 1.001, 0.0)));
  EXPECT_TRUE(std::isnan(table.radius(-1e-3, 0.0)));
  EXPECT_TRUE(std::isnan(table.radius(0.5 * camera.maxRadius(), 1.1)));
  EXPECT_TRUE(std::isnan(table.radiusMain(0.5 * camera.maxRadius(), -1.1)));
  EXPECT_TRUE(std::isnan(table.radius(std::nan(""), 0.0)));
  // A point that no ray reaches: behind the mirror, on the axis.
  EXPECT_TRUE(std::isnan(table.imageRadius(0.01, 5.0)));
}

std::string nameOf(const testing::TestParamInfo<std::shared_ptr<const CameraModel>>& test) {
  const std::array<const char*, 5> names = {"Sphere", "Hyperbola", "Equidistant", "Unified",
                                            "Ocam"};
  return names.at(test.index);
}

INSTANTIATE_TEST_SUITE_P(Cameras, ContourTableTest,
                         testing::Values(test::sphericalCamera(), test::hyperbolicCamera(),
                                         test::equidistantCamera(), test::unifiedCamera(),
                                         test::ocamCamera()),
                         nameOf);

}  // namespace
}  // namespace omnitag
