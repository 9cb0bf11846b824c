#include "../../benchmark/pixel_information.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <cstddef>
#include <memory>
#include <set>
#include <vector>

#include "../../benchmark/frame_limit.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sweep.h"
#include "camera/catadioptric_camera.h"

namespace omnitag {
namespace {

/// `white_by_first`: by the first three unknowns of a frame.
PatternPixel pixelAt(const Eigen::Vector2d& offset, double white,
                     const Eigen::Vector3d& white_by_first) {
  PatternPixel pixel;
  pixel.white = white;
  pixel.white_by_frame.head<3>() = white_by_first;
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
  const FrameMatrix information = pixelInformation(stripe(), 100.0, 2.0, 0.0).information;
  // 18 pixels that change by 300 grey levels per metre, at a noise of 2.
  EXPECT_NEAR(information(0, 0), 18.0 * 300.0 * 300.0 / 4.0, 1e-6);
  EXPECT_NEAR(information(1, 1), 0.0, 1e-9);
}

TEST(PixelInformation, IsLessWhereEdgesAreNoisier) {
  const FrameMatrix information = pixelInformation(stripe(), 100.0, 2.0, 0.0009).information;
  // 3 grey levels more of 100.
  EXPECT_NEAR(information(0, 0), 18.0 * 300.0 * 300.0 / (4.0 + 9.0), 1e-6);
}

TEST(PixelInformation, StepsToTheMostLikelyPose) {
  std::vector<PatternPixel> pixels = stripe();
  constexpr double kStep = 0.01;
  for (PatternPixel& pixel : pixels) {
    pixel.grey = 20.0 + 100.0 * (pixel.white + kStep * pixel.white_by_frame.x()) +
                 7.0 * pixel.white * pixel.offset.y();
  }
  const FrameEquations equations = pixelInformation(pixels, 100.0, 2.0, 0.0);
  EXPECT_NEAR(equations.gradient.x() / equations.information(0, 0), kStep, 1e-9);
}

TEST(PixelInformation, IsNoneWhereLightWouldLookTheSame) {
  std::vector<PatternPixel> pixels;
  for (int i = 0; i <= 20; ++i) {
    const double white = 0.05 * i;
    const Eigen::Vector2d offset(std::cos(i), std::sin(i));
    pixels.push_back(pixelAt(offset, white, {white, 1.0 - white, white * offset.y()}));
  }
  EXPECT_LT(pixelInformation(pixels, 100.0, 2.0, 0.0).information.norm(), 1e-6);
}

/// Off by as many pixels in each mode.
std::shared_ptr<const CameraModel> uncertainCamera() {
  auto camera = std::make_shared<CatadioptricCamera>(
      dynamic_cast<const CatadioptricCamera&>(*test::sphericalCamera()));
  camera->setUncertainty({0.5, 0.8, 0.6, 0.7});
  return camera;
}

/// A marker before a spherical mirror.
class PatternPixelsTest : public testing::Test {
 protected:
  PatternPixelsTest() {
    // Turned in its plane, so that its edges run across the pixels at all places.
    addMarker(5, {3.0, 0.5, 1.3}, kPi - 0.4);
  }

  void addMarker(int id, const Eigen::Vector3d& center, double direction) {
    Marker marker;
    marker.family = "tag36h11";
    marker.id = id;
    marker.size = 0.8;
    marker.map_from_marker = Eigen::Translation3d(center) * uprightOrientation(direction, 0.3);
    marker.deviation = 0.004;
    marker.orientation_deviation = 0.02;
    map_.markers.push_back(marker);
  }

  cv::Mat render(const MountedCamera& camera, const Pose& map_from_base) const {
    constexpr int kSamples = 24;
    return test::renderPanorama(map_, camera, map_from_base, kSamples);
  }

  std::vector<PatternPixel> pixelsOf(const cv::Mat& image, const Marker& marker) const {
    return patternPixels(image, camera_, kPose, marker, TagPattern(marker.family, marker.id),
                         kRendering.samples);
  }

  /// What is seen once an unknown of the frame has changed.
  std::vector<PatternPixel> pixelsAfter(int unknown, double step) const {
    const FrameVector change = step * FrameVector::Unit(unknown);
    return pixelsOf(
        render(camera_.withError(change.tail<kImagingUnknowns>()), moved(kPose, change.head<6>())),
        map_.markers.front());
  }

  static constexpr Pose kPose{0.1, -0.2, 0.3};
  static constexpr Rendering kRendering{2.0, 4};
  MarkerMap map_;
  MountedCamera camera_{uncertainCamera(), test::lookingDown()};
};

TEST_F(PatternPixelsTest, HaveTheGreysOfARenderedImage) {
  const auto pixels = pixelsOf(render(camera_, kPose), map_.markers.front());
  ASSERT_GT(pixels.size(), 200U);
  const Light light = fitLight(pixels, 0.0);
  EXPECT_GT(light.contrast, 50.0);
  for (const PatternPixel& pixel : pixels) {
    // The renderer's 24 by 24 samples: an edge along their rows is up to 1/48 off.
    EXPECT_NEAR(light.black + light.contrast * pixel.white, pixel.grey, 0.045 * light.contrast);
    if (pixel.white > 0.1 && pixel.white < 0.9) {
      EXPECT_FALSE(pixel.isEven());
    }
  }
}

TEST_F(PatternPixelsTest, ChangeAsRenderedImagesDo) {
  const Marker& marker = map_.markers.front();
  const Light light = fitLight(pixelsOf(render(camera_, kPose), marker), 0.0);
  FrameJacobian center_by_frame;
  ASSERT_TRUE(camera_.pixelFromMap(kPose, marker.center(), &center_by_frame));
  for (int i = 0; i < 6 + kCameraModes; i += test::kSweepStride) {
    // A fifth of a pixel from one to the other.
    const double step = 0.1 / center_by_frame.col(i).norm();
    const auto after = pixelsAfter(i, step);
    const auto before = pixelsAfter(i, -step);
    double expected = 0.0;
    double actual = 0.0;
    double both = 0.0;
    for (std::size_t p = 0; p < after.size(); ++p) {
      // Even pixels may lie at the drawing's border, beyond which the background begins.
      if (after[p].isEven()) continue;
      const double rendered = (after[p].grey - before[p].grey) / (2.0 * step * light.contrast);
      const double swept = after[p].white_by_frame[i];
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

class FrameLimitTest : public PatternPixelsTest {
 protected:
  FrameLimitTest() {
    addMarker(6, {-2.5, 1.0, 1.2}, 0.2);
    addMarker(7, {0.5, -3.0, 1.4}, 0.5 * kPi - 0.3);
    image_ = render(camera_, kPose);
  }

  Informations markersIn(const cv::Mat& image, const std::set<std::size_t>& used = {}) const {
    return markersInSight(image, camera_, map_, kPose, kRendering, used);
  }

  /// The change of the base's pose that shows a marker as one does that has moved by a unit along
  /// each axis of the map, and turned by one about it: both move as one body.
  static PoseMatrix poseByMarker(const Marker& marker) {
    constexpr double kStep = 1e-5;
    PoseMatrix by_marker;
    for (int i = 0; i < 6; ++i) {
      const auto seenFrom = [&](double step) {
        const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i % 3);
        Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
        if (i < 3) {
          motion.translation() = step * axis;
        } else {
          motion = Eigen::Translation3d(marker.center()) * Eigen::AngleAxisd(step, axis) *
                   Eigen::Translation3d(-marker.center());
        }
        return difference(Pose::fromIsometry(motion.inverse() * kPose.toIsometry()), kPose);
      };
      by_marker.col(i) = (seenFrom(kStep) - seenFrom(-kStep)) / (2.0 * kStep);
    }
    return by_marker;
  }

  /// Adds a marker's pixels, its six numbers and the four of its light from `first` on.
  void addTo(Eigen::MatrixXd* information, int first, const Marker& marker) const {
    const double noise_variance = kRendering.noise * kRendering.noise + 1.0 / 12.0;
    const auto pixels = pixelsOf(image_, marker);
    const double contrast = fitLight(pixels, std::sqrt(noise_variance)).contrast;
    const double edge_variance = contrast * contrast * samplingVariance(pixels);
    const PoseMatrix pose_by_marker = poseByMarker(marker);
    for (const PatternPixel& pixel : pixels) {
      const double variance = noise_variance + (pixel.isEven() ? 0.0 : edge_variance);
      Eigen::VectorXd by_all = Eigen::VectorXd::Zero(information->rows());
      const FrameVector by_frame = contrast * pixel.white_by_frame;
      by_all.head<kFrameUnknowns>() = by_frame;
      by_all.segment<6>(first) = pose_by_marker.transpose() * by_frame.head<6>();
      by_all.segment<4>(first + 6) << 1.0, pixel.white, pixel.white * pixel.offset.x(),
          pixel.white * pixel.offset.y();
      *information += by_all * by_all.transpose() / variance;
    }
    information->diagonal().segment<3>(first).array() += 1.0 / std::pow(marker.deviation, 2);
    information->diagonal().segment<3>(first + 3).array() +=
        1.0 / std::pow(marker.orientation_deviation, 2);
  }

  cv::Mat image_;
};

TEST_F(FrameLimitTest, IsThatOfNormalEquationsWithAllUnknowns) {
  const Informations in_sight = markersIn(image_);
  ASSERT_EQ(in_sight.size(), 3U);
  const PosePrior prior = PosePrior::standing({}, 0.007, 0.012)
                              .withPlace(kPose, Eigen::Vector3d(100.0, 100.0, 200.0).asDiagonal());
  const FrameMatrix covariance = leastCovariance(in_sight, map_, kPose, prior);

  constexpr int kOfMarker = 10;
  const int unknowns = kFrameUnknowns + kOfMarker * static_cast<int>(map_.markers.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(unknowns, unknowns);
  int first = kFrameUnknowns;
  for (const Marker& marker : map_.markers) {
    addTo(&information, first, marker);
    first += kOfMarker;
  }
  PoseVector of_prior;
  of_prior << 100.0, 100.0, 200.0, std::pow(0.007, -2), std::pow(0.012, -2), std::pow(0.012, -2);
  information.diagonal().head<6>() += of_prior;
  information.diagonal().segment<kImagingUnknowns>(6).array() += 1.0;
  const FrameMatrix expected =
      information.fullPivLu().inverse().topLeftCorner<kFrameUnknowns, kFrameUnknowns>();
  const FrameVector deviations = expected.diagonal().cwiseSqrt();
  const FrameMatrix scaled = deviations.cwiseInverse().asDiagonal() * (covariance - expected) *
                             deviations.cwiseInverse().asDiagonal();
  EXPECT_LT(scaled.cwiseAbs().maxCoeff(), 1e-6);
  // Millimetres: neither the prediction alone nor pixels that know everything else.
  EXPECT_GT(std::sqrt(expected(0, 0)), 1e-3);
  EXPECT_LT(std::sqrt(expected(0, 0)), 2e-2);
}

TEST_F(FrameLimitTest, HiddenMarkersDoNotCountUnlessTheyAreUsed) {
  cv::Mat image = image_.clone();
  const auto center = camera_.pixelFromMap(kPose, map_.markers[1].center());
  ASSERT_TRUE(center);
  constexpr int kReach = 5;
  image(cv::Rect(cvRound(center->x()) - kReach, cvRound(center->y()) - kReach, 2 * kReach,
                 2 * kReach)) = 120;
  const Informations in_sight = markersIn(image);
  EXPECT_EQ(in_sight.size(), 2U);
  EXPECT_EQ(in_sight.count(1), 0U);
  EXPECT_EQ(markersIn(image, {1}).size(), 3U);
}

}  // namespace
}  // namespace omnitag
