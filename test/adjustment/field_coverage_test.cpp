#include "adjustment/field_coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "../support/sample_cameras.h"

namespace omnitag {
namespace {

/// The pixel in the middle of a cell: a third of the field's area per ring, an eighth of a turn per
/// sector.
Eigen::Vector2d middleOf(const CameraModel& camera, const FieldCell& cell) {
  const double inner = std::pow(camera.minRadius(), 2);
  const double outer = std::pow(camera.maxRadius(), 2);
  const double share = (static_cast<double>(cell.ring) + 0.5) / 3.0;
  const double radius = std::sqrt(inner + share * (outer - inner));
  const double azimuth = radians(45.0) * static_cast<double>(cell.sector);
  // The lens of the camera has no distortion.
  return camera.imagePlane().principalPoint() +
         camera.imagePlane().affine() * radius *
             Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
}

TEST(FieldCoverageTest, TellsTheCellOfAPixel) {
  const auto camera = test::sphericalCamera();
  const Eigen::Vector2d centre = camera->imagePlane().principalPoint();
  const double rim = camera->rimPixels();
  EXPECT_EQ(fieldCellOf(*camera, centre + Eigen::Vector2d(0.95 * rim, 0.0)), (FieldCell{2, 0}));
  EXPECT_EQ(fieldCellOf(*camera, centre + Eigen::Vector2d(0.0, 0.95 * rim)), (FieldCell{2, 2}));
  EXPECT_EQ(fieldCellOf(*camera, centre - Eigen::Vector2d(0.65 * rim, 0.65 * rim)),
            (FieldCell{2, 5}));
  EXPECT_FALSE(fieldCellOf(*camera, centre + Eigen::Vector2d(1.05 * rim, 0.0)));
}

TEST(FieldCoverageTest, NamesTheCellsWithoutAPixel) {
  const auto camera = test::sphericalCamera();
  const FieldCell empty{2, 4};
  std::vector<Eigen::Vector2d> pixels;
  for (std::size_t ring = 0; ring < 3; ++ring) {
    for (std::size_t sector = 0; sector < 8; ++sector) {
      const FieldCell cell{ring, sector};
      EXPECT_EQ(fieldCellOf(*camera, middleOf(*camera, cell)), cell);
      if (!(cell == empty)) pixels.push_back(middleOf(*camera, cell));
    }
  }
  const FieldCoverage coverage = fieldCoverage(*camera, pixels);
  EXPECT_NEAR(coverage.share, 23.0 / 24.0, 1e-12);
  EXPECT_EQ(coverage.empty, std::vector<FieldCell>{empty});
  EXPECT_EQ(coverage.missing, std::vector<std::string>{"the rim (left)"});

  pixels.push_back(middleOf(*camera, empty));
  EXPECT_EQ(fieldCoverage(*camera, pixels).share, 1.0);
  EXPECT_TRUE(fieldCoverage(*camera, pixels).empty.empty());
  EXPECT_EQ(fieldCoverage(*camera, {}).empty.size(), 24U);
}

}  // namespace
}  // namespace omnitag
