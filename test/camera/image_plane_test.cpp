#include "omnitag/camera/image_plane.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>

#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

const ImagePlane::Distortion kDistortion{-0.35, 0.12, 0.001, -0.002, 0.05};

ImagePlane lensWith(const ImagePlane::Distortion& distortion) {
  return {Eigen::Vector2d(700.0, 760.0).asDiagonal(), Eigen::Vector2d(331.3, 227.8), distortion};
}

/// Calls `check` for points in a disc of the ideal plane.
template <typename Check>
void forEachPoint(double radius, Check check) {
  for (double share = 0.0; share <= 1.0; share += 0.05) {
    for (double azimuth = 0.0; azimuth < 2.0 * kPi; azimuth += 0.3) {
      check(
          Eigen::Vector2d(share * radius * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth))));
    }
  }
}

TEST(ImagePlane, isAffineWithoutDistortion) {
  Eigen::Matrix2d affine;
  affine << 700.0, 3.0, -2.0, 760.0;
  const ImagePlane plane(affine, {331.3, 227.8});
  EXPECT_FALSE(plane.isDistorted());
  Eigen::Matrix2d jacobian;
  const Eigen::Vector2d pixel = plane.pixelFromIdeal({0.2, -0.1}, &jacobian);
  EXPECT_NEAR(pixel.x(), 331.3 + 700.0 * 0.2 - 3.0 * 0.1, 1e-12);
  EXPECT_NEAR(pixel.y(), 227.8 - 2.0 * 0.2 - 760.0 * 0.1, 1e-12);
  EXPECT_EQ(jacobian, affine);
  EXPECT_NEAR(plane.scale(), std::sqrt(700.0 * 760.0 + 6.0), 1e-9);
  EXPECT_LT((*plane.idealFromPixel(pixel) - Eigen::Vector2d(0.2, -0.1)).norm(), 1e-15);
}

TEST(ImagePlane, distortsAsOpenCv) {
  // Pixels of these points by cv::projectPoints of OpenCV 4.6 with the same lens.
  const struct {
    Eigen::Vector2d ideal;
    Eigen::Vector2d pixel;
  } kReference[] = {
      {{0.0, 0.0}, {331.3, 227.8}},
      {{0.1, 0.0}, {401.0138435, 227.8076}},
      {{0.0, 0.3}, {331.174, 449.0531266}},
      {{-0.25, 0.4}, {168.165611269531, 510.8157181375}},
      {{0.5, -0.35}, {640.934529804687, -7.635482651563}},
      {{-0.6, -0.6}, {-18.337568, -150.1649024}},
  };
  const ImagePlane plane = lensWith(kDistortion);
  EXPECT_TRUE(plane.isDistorted());
  for (const auto& [ideal, pixel] : kReference) {
    EXPECT_LT((plane.pixelFromIdeal(ideal) - pixel).norm(), 1e-9) << ideal.transpose();
  }
}

TEST(ImagePlane, distortsAsBrownAndConrady) {
  // Every coefficient alone, in the polar form of the model.
  for (std::size_t i = 0; i < 5; ++i) {
    ImagePlane::Distortion distortion{};
    distortion[i] = 0.04;
    const ImagePlane plane = lensWith(distortion);
    forEachPoint(0.8, [&](const Eigen::Vector2d& ideal) {
      const double r = ideal.norm();
      const double azimuth = std::atan2(ideal.y(), ideal.x());
      const auto& [k1, k2, p1, p2, k3] = distortion;
      const double radial = r + k1 * std::pow(r, 3) + k2 * std::pow(r, 5) + k3 * std::pow(r, 7);
      // Tangential terms: r^2 times p1 (sin 2a, 2 - cos 2a) + p2 (2 + cos 2a, sin 2a).
      const double sine = std::sin(2.0 * azimuth);
      const double cosine = std::cos(2.0 * azimuth);
      const double x = radial * std::cos(azimuth) + r * r * (p1 * sine + p2 * (2.0 + cosine));
      const double y = radial * std::sin(azimuth) + r * r * (p1 * (2.0 - cosine) + p2 * sine);
      const Eigen::Vector2d expected(331.3 + 700.0 * x, 227.8 + 760.0 * y);
      EXPECT_LT((plane.pixelFromIdeal(ideal) - expected).norm(), 1e-10);
    });
  }
}

TEST(ImagePlane, hasTheDerivativeOfItsDistortion) {
  const ImagePlane plane = lensWith(kDistortion);
  constexpr double kStep = 1e-5;
  forEachPoint(0.7, [&](const Eigen::Vector2d& ideal) {
    Eigen::Matrix2d jacobian;
    EXPECT_EQ(plane.pixelFromIdeal(ideal, &jacobian), plane.pixelFromIdeal(ideal));
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d offset = kStep * Eigen::Vector2d::Unit(axis);
      const Eigen::Vector2d numeric =
          (plane.pixelFromIdeal(ideal + offset) - plane.pixelFromIdeal(ideal - offset)) /
          (2.0 * kStep);
      EXPECT_LT((jacobian.col(axis) - numeric).norm(), 1e-5);
    }
  });
}

TEST(ImagePlane, isInvertedWhereverItSaysSo) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> strength(-0.3, 0.3);
  int inverted = 0;
  for (int i = 0; i < 500; ++i) {
    const ImagePlane plane = lensWith({strength(random), strength(random), 0.05 * strength(random),
                                       0.05 * strength(random), strength(random)});
    constexpr double kRadius = 0.9;
    if (!plane.isInvertibleUpTo(kRadius)) continue;
    ++inverted;
    forEachPoint(0.999 * kRadius, [&](const Eigen::Vector2d& ideal) {
      const std::optional<Eigen::Vector2d> again =
          plane.idealFromPixel(plane.pixelFromIdeal(ideal));
      ASSERT_TRUE(again) << ideal.transpose();
      Eigen::Matrix2d jacobian;
      plane.pixelFromIdeal(ideal, &jacobian);
      const double conditioning = std::max(1.0, 760.0 * jacobian.inverse().norm());
      ASSERT_LT((*again - ideal).norm(), 1e-13 * conditioning * conditioning) << ideal.transpose();
    });
  }
  EXPECT_GT(inverted, 100);
}

TEST(ImagePlane, knowsWhereItsDistortionFolds) {
  // r + k1 r^3 turns back at r = 1 / sqrt(-3 k1).
  const ImagePlane plane = lensWith({-1.0 / 3.0, 0.0, 0.0, 0.0, 0.0});
  EXPECT_TRUE(plane.isInvertibleUpTo(0.999));
  EXPECT_FALSE(plane.isInvertibleUpTo(1.001));
  EXPECT_TRUE(lensWith({}).isInvertibleUpTo(1e6));
  // It reaches no farther than 2/3.
  EXPECT_TRUE(plane.idealFromPixel({331.3 + 700.0 * 0.66, 227.8}));
  EXPECT_FALSE(plane.idealFromPixel({331.3 + 700.0 * 0.68, 227.8}));
}

TEST(ImagePlane, invertsNothingThatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(lensWith(kDistortion).idealFromPixel({nan, 0.0}));
}

}  // namespace
}  // namespace omnitag
