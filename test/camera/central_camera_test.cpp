#include "camera/central_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "central_samples.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

class EveryCentralCamera : public testing::TestWithParam<CentralSample> {
 protected:
  const CentralCamera& camera() const { return *GetParam().camera; }

  /// A direction `angle` off the end of the axis that the image's middle shows.
  Eigen::Vector3d direction(double angle, double azimuth) const {
    const double along = camera().throughMirror() ? -std::cos(angle) : std::cos(angle);
    return {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), along};
  }
};

TEST_P(EveryCentralCamera, agreesWithItsOracleAllOverItsField) {
  constexpr int kAngles = 200;
  constexpr int kAzimuths = 48;
  double worst = 0.0;
  double farthest = 0.0;
  int compared = 0;
  for (int i = 1; i <= kAngles; ++i) {
    for (int k = 0; k < kAzimuths; ++k) {
      const double angle = camera().maxAngle() * (i - 0.01) / kAngles;
      const Eigen::Vector3d point = 2.7 * direction(angle, 0.1 + 2.0 * kPi * k / kAzimuths);
      const auto pixel = camera().pixelFromPoint(point);
      const auto expected = GetParam().oracle(point);
      if (!expected) continue;
      ASSERT_EQ(pixel.has_value(), camera().isInImage(*expected)) << point.transpose();
      if (!pixel) continue;
      worst = std::max(worst, (*pixel - *expected).norm());
      farthest = std::max(farthest, angle);
      ++compared;
    }
  }
  EXPECT_LT(worst, 1e-8);
  EXPECT_GT(compared, 1000);
  EXPECT_GT(farthest, std::min(camera().maxAngle(), kPi / 2) - 0.05);
  RecordProperty("largest_error_px", testing::PrintToString(worst));
}

TEST_P(EveryCentralCamera, hasItsViewpointAtTheOriginAndItsAxisAtThePrincipalPoint) {
  const auto ray = camera().rayFromPixel(camera().imagePlane().principalPoint());
  ASSERT_TRUE(ray);
  EXPECT_EQ(ray->origin, Eigen::Vector3d::Zero());
  EXPECT_LT((ray->direction - direction(0.0, 0.0)).norm(), 1e-12);
  const auto pixel = camera().pixelFromPoint(3.0 * direction(0.0, 0.0));
  ASSERT_TRUE(pixel);
  EXPECT_LT((*pixel - camera().imagePlane().principalPoint()).norm(), 1e-12);
}

TEST_P(EveryCentralCamera, endsAtItsLargestAngleAndSeesNothingBehindIt) {
  EXPECT_FALSE(camera().imageFromPoint(0.0, 0.0));
  const double sign = camera().throughMirror() ? -1.0 : 1.0;
  const auto sees = [&](double angle) {
    return camera().imageFromPoint(std::sin(angle), sign * std::cos(angle)).has_value();
  };
  EXPECT_TRUE(sees(camera().maxAngle() - 1e-9));
  EXPECT_FALSE(sees(camera().maxAngle() + 1e-9));
  EXPECT_FALSE(sees(kPi));
  EXPECT_TRUE(camera().rayFromRadius(camera().maxRadius()));
  EXPECT_FALSE(camera().rayFromRadius(camera().maxRadius() * (1.0 + 1e-9)));
}

TEST_P(EveryCentralCamera, keepsLeftAndRight) {
  // Never mirrored: counter-clockwise about z is from x to y, in the world as in the image.
  const auto first = camera().imagePlane().pixelFromIdeal({0.1 * camera().maxRadius(), 0.0});
  const auto second = camera().imagePlane().pixelFromIdeal({0.0, 0.1 * camera().maxRadius()});
  const Eigen::Vector3d along_u = camera().rayFromPixel(first)->direction;
  const Eigen::Vector3d along_v = camera().rayFromPixel(second)->direction;
  EXPECT_GT(along_u.x(), 0.0);
  EXPECT_GT(along_v.y(), 0.0);
  EXPECT_NEAR(along_u.y(), 0.0, 1e-12);
  EXPECT_NEAR(along_v.x(), 0.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(, EveryCentralCamera, testing::ValuesIn(centralSamples()),
                         [](const auto& info) { return info.param.name; });

TEST(Equidistant, seesBackwardsAsItsFormulaSays) {
  // OpenCV's module does not reach beyond 90 degrees; the formula does.
  const EquidistantCamera::Coefficients k{0.02, -0.003, 0.0007, -0.00004};
  const EquidistantCamera camera({1000, 1000}, lensOf(200, 210, 499.5, 480.0), k, {2.1, false});
  for (const double angle : {1.6, 1.8, 2.0, 2.0999}) {
    const long double t = angle;
    const long double radius = t + k[0] * std::pow(t, 3) + k[1] * std::pow(t, 5) +
                               k[2] * std::pow(t, 7) + k[3] * std::pow(t, 9);
    for (const double azimuth : {0.0, 0.9, 2.5, -1.2}) {
      const auto pixel =
          camera.pixelFromPoint({std::sin(angle) * std::cos(azimuth),
                                 std::sin(angle) * std::sin(azimuth), std::cos(angle)});
      ASSERT_TRUE(pixel);
      EXPECT_NEAR(pixel->x(), 499.5 + 200.0 * static_cast<double>(radius) * std::cos(azimuth),
                  1e-9);
      EXPECT_NEAR(pixel->y(), 480.0 + 210.0 * static_cast<double>(radius) * std::sin(azimuth),
                  1e-9);
    }
  }
}

TEST(Ocam, looksAlongTheToolboxsRays) {
  const OcamCalibration calibration{{-289.5569, 0.0, 1.538894e-3, -3.140320e-6, 7.206996e-9},
                                    390.949324,
                                    423.714757,
                                    0.999134,
                                    -0.000325,
                                    -0.000071,
                                    {848, 800}};
  const OcamCamera camera(calibration);
  int backwards = 0;
  for (double u = 0.0; u < 848.0; u += 13.7) {
    for (double v = 0.0; v < 800.0; v += 11.3) {
      const auto ray = camera.rayFromPixel({u, v});
      ASSERT_TRUE(ray);
      EXPECT_LT((ray->direction - test::cam2world(calibration, {u, v})).norm(), 1e-12);
      backwards += ray->direction.z() < 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(backwards, 10);
}

/// Compares rays from all over the image with the angles off the axis that a formula gives for
/// radii of the ideal plane.
void expectAngles(const CentralCamera& camera, const std::function<double(double)>& angle_of) {
  int compared = 0;
  for (double radius = 0.003; radius < camera.maxRadius(); radius += 0.0071) {
    const auto ray = camera.rayFromRadius(radius);
    ASSERT_TRUE(ray);
    EXPECT_NEAR(std::atan2(ray->direction.x(), ray->direction.y()), angle_of(radius), 1e-9);
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST(DoubleSphere, looksAlongItsAuthorsRays) {
  // Equations 46 to 50 of the paper.
  constexpr double kXi = -0.2, kAlpha = 0.6;
  const DoubleSphereCamera camera({1024, 1024}, lensOf(300, 300, 511.5, 511.5), {kXi, kAlpha});
  EXPECT_GT(camera.maxAngle(), 1.7);
  expectAngles(camera, [&](double radius) {
    const double square = radius * radius;
    const double z = (1.0 - kAlpha * kAlpha * square) /
                     (kAlpha * std::sqrt(1.0 - (2.0 * kAlpha - 1.0) * square) + 1.0 - kAlpha);
    const double scale =
        (z * kXi + std::sqrt(z * z + (1.0 - kXi * kXi) * square)) / (z * z + square);
    return std::atan2(scale * radius, scale * z - kXi);
  });
}

TEST(Eucm, looksAlongItsAuthorsRays) {
  constexpr double kAlpha = 0.6, kBeta = 1.1;
  const EucmCamera camera({1024, 1024}, lensOf(430, 430, 511.5, 511.5), {kAlpha, kBeta});
  EXPECT_GT(camera.maxAngle(), 1.5);
  expectAngles(camera, [&](double radius) {
    const double square = kBeta * radius * radius;
    const double z = (1.0 - kAlpha * kAlpha * square) /
                     (kAlpha * std::sqrt(1.0 - (2.0 * kAlpha - 1.0) * square) + 1.0 - kAlpha);
    return std::atan2(radius, z);
  });
}

std::string refusalOf(const std::function<void()>& make) {
  try {
    make();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Field, isRefusedWhereTheDistortionFoldsWithinIt) {
  const ImageSize size{500, 500};
  const ImagePlane lens = lensOf(150, 150, 249.5, 249.5);
  // theta (1 - theta^2 / 3) folds at 1.
  const auto folding = [&](std::optional<double> max_angle) {
    return [&, max_angle] {
      EquidistantCamera(size, lens, {-1.0 / 3.0, 0.0, 0.0, 0.0}, {max_angle, false});
    };
  };
  EXPECT_EQ(refusalOf(folding(0.99)), "");
  EXPECT_NE(refusalOf(folding(1.01)).find("folds the image at 0.99"), std::string::npos);
  EXPECT_EQ(refusalOf(folding(std::nullopt)), "");
  EXPECT_NE(refusalOf([&] {
              UnifiedCamera(size, lens, 2.0, {2.1, false});
            }).find("xi: expected"),
            std::string::npos);
  EXPECT_EQ(refusalOf([&] { UnifiedCamera(size, lens, 2.0, {2.09, false}); }), "");
  const ImagePlane barrel = lensOf(150, 150, 249.5, 249.5, 0.0, {-1.0 / 3.0, 0, 0, 0, 0});
  EXPECT_NE(refusalOf([&] {
              UnifiedCamera(size, barrel, 1.0, {1.8, false});
            }).find("distortion:"),
            std::string::npos);
  EXPECT_EQ(refusalOf([&] { UnifiedCamera(size, barrel, 1.0, {1.5, false}); }), "");
  // alpha > 1 / 2 folds where (2 alpha - 1) beta r^2 = 1.
  EXPECT_NE(refusalOf([&] {
              EucmCamera(size, lens, {0.8, 1.0}, {2.5, false});
            })
                .find("alpha, beta: expected an image that grows with the angle off the axis up to "
                      "max_angle, 2.5 rad, found one that folds the image at 1.82"),
            std::string::npos);
  EXPECT_EQ(refusalOf([&] { EucmCamera(size, lens, {0.8, 1.0}, {1.82, false}); }), "");
  EXPECT_NE(refusalOf([&] {
              DoubleSphereCamera(size, lens, {0.0, 0.8}, {2.5, false});
            }).find("xi, alpha: expected an image"),
            std::string::npos);
  EXPECT_EQ(refusalOf([&] { DoubleSphereCamera(size, lens, {0.0, 0.8}, {1.82, false}); }), "");
  const OcamCalibration backwards{{100.0, 0.0, 1e-3}, 240, 320, 1, 0, 0, {640, 480}};
  EXPECT_NE(refusalOf([&] { OcamCamera camera(backwards); }).find("polynomial: expected"),
            std::string::npos);
  const OcamCalibration flat{{-100.0, 0.0, 1e-3}, 240, 320, 1, 1, 1, {640, 480}};
  EXPECT_NE(refusalOf([&] { OcamCamera camera(flat); }).find("affine parameters: expected"),
            std::string::npos);
}

TEST(Field, endsWhereTheImageDoesOrTheDistortionFolds) {
  const double diagonal = 250.0 * std::sqrt(2.0);
  const EquidistantCamera whole({500, 500}, lensOf(150, 150, 249.5, 249.5), {});
  EXPECT_NEAR(whole.maxAngle(), diagonal / 150.0, 1e-6);
  const EquidistantCamera folding({500, 500}, lensOf(500, 500, 249.5, 249.5),
                                  {-1.0 / 3.0, 0.0, 0.0, 0.0});
  EXPECT_NEAR(folding.maxAngle(), 1.0, 2e-3);
  const UnifiedCamera pinhole({500, 500}, lensOf(250, 250, 249.5, 249.5), 0.0);
  EXPECT_NEAR(pinhole.maxAngle(), std::atan(std::sqrt(2.0)), 1e-6);
}

}  // namespace
}  // namespace omnitag
