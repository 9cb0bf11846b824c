#include "omnitag/camera/camera_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "central_samples.h"
#include "sample_cameras.h"

namespace omnitag {
namespace {

struct AnyCamera {
  std::string name;
  std::shared_ptr<const CameraModel> camera;
};

/// How gtest names a camera.
void PrintTo(const AnyCamera& sample, std::ostream* out) { *out << sample.name; }

std::vector<AnyCamera> allSamples() {
  std::vector<AnyCamera> samples;
  for (const SampleCamera& sample : sampleCameras()) {
    samples.push_back({sample.name, std::make_shared<CatadioptricCamera>(sample.camera)});
  }
  for (const CentralSample& sample : centralSamples()) {
    samples.push_back({sample.name, sample.camera});
  }
  return samples;
}

/// What holds for every camera, whatever its model.
class EveryCamera : public testing::TestWithParam<AnyCamera> {
 protected:
  const CameraModel& camera() const { return *GetParam().camera; }

  /// Calls `check` for positions all over the image.
  template <typename Check>
  void forEachPixel(double step, Check check) const {
    const ImageSize size = camera().imageSize();
    for (double v = -0.499; v < size.height - 0.5; v += step) {
      for (double u = -0.499; u < size.width - 0.5; u += step) check(Eigen::Vector2d(u, v));
    }
  }
};

TEST_P(EveryCamera, takesPixelsToPointsAndBack) {
  int visible = 0;
  double worst = 0.0;
  forEachPixel(2.3, [&](const Eigen::Vector2d& pixel) {
    const std::optional<Ray> ray = camera().rayFromPixel(pixel);
    if (!ray) return;
    ++visible;
    ASSERT_NEAR(ray->direction.norm(), 1.0, 1e-14);
    for (const double range : {0.001, 0.05, 0.3, 2.0, 50.0, 1e6}) {
      const std::optional<Eigen::Vector2d> again =
          camera().pixelFromPoint(ray->origin + range * ray->direction);
      ASSERT_TRUE(again) << pixel.transpose() << " at " << range << " m";
      ASSERT_LT((*again - pixel).norm(), 1e-6) << pixel.transpose() << " at " << range << " m";
      worst = std::max(worst, (*again - pixel).norm());
    }
  });
  EXPECT_GT(visible, 2000);
  RecordProperty("largest_error_px", testing::PrintToString(worst));
}

TEST_P(EveryCamera, hasTheDerivativesOfItsProjection) {
  int compared = 0;
  double worst = 0.0;
  forEachPixel(31.7, [&](const Eigen::Vector2d& pixel) {
    const std::optional<Ray> ray = camera().rayFromPixel(pixel);
    if (!ray) return;
    for (const double range : {0.05, 2.0, 50.0}) {
      const Eigen::Vector3d point = ray->origin + range * ray->direction;
      Eigen::Matrix<double, 2, 3> jacobian;
      const std::optional<Eigen::Vector2d> with = camera().pixelFromPoint(point, &jacobian);
      const std::optional<Eigen::Vector2d> without = camera().pixelFromPoint(point);
      ASSERT_TRUE(with && without);
      ASSERT_EQ(*with, *without);
      Eigen::Matrix<double, 2, 3> numeric;
      const double step = 1e-4 * range;
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d offset = step * Eigen::Vector3d::Unit(axis);
        const auto ahead = camera().pixelFromPoint(point + offset);
        const auto behind = camera().pixelFromPoint(point - offset);
        if (!ahead || !behind) return;  // at the edge of the view
        numeric.col(axis) = (*ahead - *behind) / (2.0 * step);
      }
      ++compared;
      ASSERT_LT((jacobian - numeric).norm(), 1e-6 * jacobian.norm())
          << pixel.transpose() << " at " << range << " m";
      worst = std::max(worst, (jacobian - numeric).norm() / jacobian.norm());
    }
  });
  EXPECT_GT(compared, 50);
  RecordProperty("largest_error", testing::PrintToString(worst));
}

TEST_P(EveryCamera, scalesToImagesOfItsPixelsPutTogether) {
  const ImageSize size = camera().imageSize();
  EXPECT_EQ(camera().ofImage({2 * size.width, 2 * size.height})->imageSize().width, size.width);
  const auto scalable = std::const_pointer_cast<CameraModel>(camera().ofImage(size));
  scalable->setScalesToImage(true);
  scalable->setUncertainty({1.0, 2.0, 3.0, 4.0});
  EXPECT_FALSE(scalable->ofImage({size.width, size.height - 1}));
  EXPECT_FALSE(scalable->ofImage({2 * size.width, 3 * size.height}));
  EXPECT_FALSE(scalable->ofImage({0, 0}));
  for (const double factor : {1.0 / 3.0, 0.5, 1.0, 2.0}) {
    // Pixels that an odd number leaves over at the end are cut off.
    const ImageSize scaled{static_cast<int>(factor * size.width + 1e-9),
                           static_cast<int>(factor * size.height + 1e-9)};
    const auto other = scalable->ofImage(scaled);
    ASSERT_TRUE(other) << factor;
    EXPECT_EQ(other->imageSize().height, scaled.height);
    EXPECT_NEAR(other->uncertainty().rim, 4.0 * factor, 1e-12);
    int compared = 0;
    forEachPixel(31.7, [&](const Eigen::Vector2d& pixel) {
      const std::optional<Ray> ray = camera().rayFromPixel(pixel);
      // Positions from the image's corner scale; the first pixel's centre is half a pixel off.
      const Eigen::Vector2d half(0.5, 0.5);
      const Eigen::Vector2d expected = factor * (pixel + half) - half;
      if (!ray || !other->isInImage(expected)) return;
      const auto image = other->pixelFromPoint(ray->origin + 2.0 * ray->direction);
      ASSERT_TRUE(image);
      EXPECT_LT((*image - expected).norm(), 1e-6);
      EXPECT_TRUE(other->tabulatedRayFromPixel(expected));
      ++compared;
    });
    EXPECT_GT(compared, 50);
  }
}

TEST_P(EveryCamera, seesNothingWhereNothingIsNumber) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double wrong : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_FALSE(camera().imageFromPoint(wrong, 0.0));
    EXPECT_FALSE(camera().imageFromPoint(1.0, wrong));
    EXPECT_FALSE(camera().rayFromRadius(wrong));
    EXPECT_FALSE(camera().rayFromPixel({wrong, 200.0}));
    EXPECT_FALSE(camera().rayFromPixel({200.0, wrong}));
    EXPECT_FALSE(camera().pixelFromPoint({wrong, 1.0, 0.0}));
    EXPECT_FALSE(camera().pixelFromPoint({1.0, wrong, 0.0}));
    EXPECT_FALSE(camera().pixelFromPoint({1.0, 1.0, wrong}));
  }
  EXPECT_FALSE(camera().rayFromPixel({-0.51, 200.0}));
  EXPECT_FALSE(camera().rayFromPixel({200.0, camera().imageSize().height - 0.49}));
  EXPECT_FALSE(camera().rayFromRadius(-1e-9));
  EXPECT_FALSE(camera().imageFromPoint(-1.0, 0.0));
}

INSTANTIATE_TEST_SUITE_P(, EveryCamera, testing::ValuesIn(allSamples()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace omnitag
