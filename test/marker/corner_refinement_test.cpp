#include "marker/corner_refinement.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace omnitag {
namespace {

constexpr int kModules = 8;

Corners<Eigen::Vector2d> square(const Eigen::Vector2d& center, double edge, double angle) {
  const Eigen::Rotation2Dd turn(angle);
  Corners<Eigen::Vector2d> corners = {Eigen::Vector2d(-1.0, 1.0), Eigen::Vector2d(1.0, 1.0),
                                      Eigen::Vector2d(1.0, -1.0), Eigen::Vector2d(-1.0, -1.0)};
  for (Eigen::Vector2d& corner : corners) corner = center + turn * (0.5 * edge * corner);
  return corners;
}

/// Signed distance from the square's edge, positive inside.
double depth(const Eigen::Vector2d& point, const Eigen::Vector2d& center, double edge,
             double angle) {
  const Eigen::Vector2d local = Eigen::Rotation2Dd(-angle) * (point - center);
  return 0.5 * edge - local.cwiseAbs().maxCoeff();
}

/// A dark square on bright ground, its edges blurred over `blur` pixels on each side; the light
/// grows by `slope` per pixel to the right.
cv::Mat render(const Eigen::Vector2d& center, double edge, double angle, double blur,
               double slope) {
  constexpr int kSize = 80;
  cv::Mat image(kSize, kSize, CV_8UC1);
  for (int v = 0; v < kSize; ++v) {
    for (int u = 0; u < kSize; ++u) {
      const double inside = depth(Eigen::Vector2d(u, v), center, edge, angle);
      const double share = std::clamp(0.5 + 0.5 * inside / blur, 0.0, 1.0);
      const double light = 1.0 + slope * (u - 0.5 * kSize);
      image.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(light * (180.0 - 140.0 * share));
    }
  }
  return image;
}

double largestError(const Corners<Eigen::Vector2d>& a, const Corners<Eigen::Vector2d>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

TEST(RefineCorners, FindsThemFromHalfAPixelOff) {
  for (const double angle : {0.0, 0.01, 0.3, 0.785, 3.0}) {
    for (const double fraction : {0.0, 0.2, 0.5, 0.8}) {
      const Eigen::Vector2d center(40.0 + fraction, 39.0 - 0.7 * fraction);
      const Corners<Eigen::Vector2d> truth = square(center, 40.0, angle);
      const Corners<Eigen::Vector2d> start =
          square(center + Eigen::Vector2d(0.35, -0.3), 40.5, angle + 0.005);
      const cv::Mat image = render(center, 40.0, angle, 1.0, 0.0);
      EXPECT_LT(largestError(refineCorners(image, start, kModules), truth), 0.03)
          << angle << " " << fraction;
    }
  }
}

TEST(RefineCorners, BothSidesMayBeTheBrightOne) {
  const Corners<Eigen::Vector2d> truth = square({40.3, 39.6}, 40.0, 0.2);
  const cv::Mat image = 255 - render({40.3, 39.6}, 40.0, 0.2, 1.0, 0.0);
  const Corners<Eigen::Vector2d> start = square({40.0, 40.0}, 40.0, 0.2);
  EXPECT_LT(largestError(refineCorners(image, start, kModules), truth), 0.03);
}

TEST(RefineCorners, UnevenLightDoesNotMoveThem) {
  const Corners<Eigen::Vector2d> truth = square({40.3, 39.6}, 40.0, 0.2);
  const cv::Mat image = render({40.3, 39.6}, 40.0, 0.2, 1.0, 0.008);
  EXPECT_LT(largestError(refineCorners(image, truth, kModules), truth), 0.05);
}

TEST(RefineCorners, StayWhereThereIsNothingToSee) {
  const Corners<Eigen::Vector2d> start = square({40.0, 40.0}, 40.0, 0.2);
  EXPECT_LT(largestError(refineCorners(cv::Mat(80, 80, CV_8UC1, cv::Scalar(100)), start, kModules),
                         start),
            1e-9);
  const Corners<Eigen::Vector2d> outside = square({-100.0, 40.0}, 40.0, 0.2);
  EXPECT_LT(
      largestError(refineCorners(render({40.0, 40.0}, 40.0, 0.2, 1.0, 0.0), outside, kModules),
                   outside),
      1e-9);
}

}  // namespace
}  // namespace omnitag
