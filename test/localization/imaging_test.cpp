#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "localization/image_lag.h"
#include "omnitag/common/angle.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

constexpr int kRows = 500;
constexpr double kMoment = 0.25;  // s between images

/// A robot among markers, with a camera whose images are blurred or exposed row by row.
class ImagingTest : public testing::Test {
 protected:
  cv::Mat sharpImage(const Pose& truth) const {
    constexpr int kSamples = 4;
    return test::renderPanorama(map_, MountedCamera(camera_, mounting_), truth, kSamples);
  }

  cv::Mat noisy(const cv::Mat& image) {
    cv::Mat noise(image.size(), CV_32F);
    cv::theRNG().state = ++seed_;
    cv::randn(noise, 0.0, 2.0);
    cv::Mat sum;
    image.convertTo(sum, CV_32F);
    sum += noise;
    cv::Mat result;
    sum.convertTo(result, CV_8U);
    return result;
  }

  cv::Mat blurredImage(const Pose& truth, double blur) {
    cv::Mat image;
    sharpImage(truth).convertTo(image, CV_32F);
    cv::GaussianBlur(image, image, {}, blur);
    return noisy(image);
  }

  /// The mean of what is seen while the robot turns.
  cv::Mat turningImage(const Pose& truth, double angle) {
    constexpr int kSteps = 15;
    cv::Mat mean = cv::Mat::zeros(kRows, kRows, CV_32F);
    for (int i = 0; i < kSteps; ++i) {
      Pose turned = truth;
      turned.yaw += angle * ((i + 0.5) / kSteps - 0.5);
      cv::Mat image;
      sharpImage(turned).convertTo(image, CV_32F, 1.0 / kSteps);
      mean += image;
    }
    return noisy(mean);
  }

  /// Each row shows the view from where the robot then is.
  cv::Mat rollingImage(const Pose& stamped, const BaseMotion& motion, double row_time) {
    constexpr int kBands = 50;
    constexpr int kHeight = kRows / kBands;
    cv::Mat whole(kRows, kRows, CV_8UC1);
    for (int band = 0; band < kBands; ++band) {
      const double row = band * kHeight + 0.5 * (kHeight - 1);
      const Eigen::Isometry3d then = stamped.toIsometry() * motion.after(row * row_time);
      constexpr int kSamples = 3;
      const cv::Range rows(band * kHeight, (band + 1) * kHeight);
      const cv::Mat image = test::renderPanorama(map_, MountedCamera(camera_, mounting_),
                                                 Pose::fromIsometry(then), kSamples, rows);
      image.rowRange(rows).copyTo(whole.rowRange(rows));
    }
    return noisy(whole);
  }

  static Pose truthAt(int i) { return {0.05 * i, 0.1 - 0.03 * i, 0.3 + 0.04 * i}; }

  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
  MarkerMap map_{"map", test::markersAround(3.2, 0.9)};
  std::uint64_t seed_ = 0;
};

double errorOf(const FrameResult& result, const Pose& truth) {
  return result.map_from_base ? difference(result.map_from_base->pose, truth).head<2>().norm()
                              : std::numeric_limits<double>::infinity();
}

TEST_F(ImagingTest, LearnsTheBlurOfTheLens) {
  for (const double blur : {0.0, 1.0, 1.6}) {
    Localizer localizer(camera_, map_, {});
    localizer.setPose(truthAt(0));
    // Images this blurred are not read before the second one.
    const int first = blur > 1.2 ? 1 : 0;
    for (int i = 0; i < 4; ++i) {
      const Pose truth = truthAt(i);
      const cv::Mat image = blur > 0.0 ? blurredImage(truth, blur) : noisy(sharpImage(truth));
      const FrameResult result = localizer.process({kMoment * i, image, mounting_, std::nullopt});
      if (i < first) continue;
      EXPECT_NEAR(result.blur.largestDeviation(), blur, 0.25) << i;
      EXPECT_EQ(result.blur.turn_square, 0.0) << i;
      EXPECT_GE(result.acceptedMarkers(), 7) << blur << ", " << i;
      EXPECT_LT(errorOf(result, truth), blur > 1.0 ? 2e-3 : 1e-3) << blur << ", " << i;
    }
  }
}

TEST_F(ImagingTest, LearnsTheTurnDuringTheExposure) {
  const double angle = radians(1.5);
  Localizer localizer(camera_, map_, {});
  localizer.setPose(truthAt(0));
  for (int i = 0; i < 3; ++i) {
    const Pose truth = truthAt(i);
    const FrameResult result =
        localizer.process({kMoment * i, turningImage(truth, angle), mounting_, std::nullopt});
    EXPECT_NEAR(std::sqrt(result.blur.turn_square), angle, 0.15 * angle) << i;
    EXPECT_LT(result.blur.largestDeviation(), 0.4) << i;
    EXPECT_GE(result.acceptedMarkers(), 7) << i;
    EXPECT_LT(errorOf(result, truth), 1e-3) << i;
  }
}

TEST_F(ImagingTest, LooksForNoTurnWhereTheExposureIsKnown) {
  // Not even if odometry disagrees with the true turn.
  LocalizerConfig config;
  config.shutter.exposure_time = 0.02;
  Localizer localizer(camera_, map_, config);
  localizer.setPose(truthAt(0));
  for (int i = 0; i < 2; ++i) {
    const Pose truth = truthAt(i);
    Frame frame{kMoment * i, turningImage(truth, radians(1.5)), mounting_, truth};
    frame.velocity = PoseVector::Zero();
    const FrameResult result = localizer.process(frame);
    EXPECT_GE(result.acceptedMarkers(), 6) << i;
    EXPECT_EQ(result.blur.turn_square, 0.0) << i;
  }
}

TEST_F(ImagingTest, FindsARobotInBlurredImages) {
  Localizer localizer(camera_, map_, {});
  int found = 0;
  for (int i = 0; i < 3; ++i) {
    const Pose truth = truthAt(0);
    const FrameResult result =
        localizer.process({kMoment * i, blurredImage(truth, 1.8), mounting_, std::nullopt});
    found += errorOf(result, truth) < 5e-3 ? 1 : 0;
  }
  EXPECT_GE(found, 2);
}

/// A near marker leaves the pose vague; the others are too blurred to be recognized if they may be
/// anywhere within many pixels.
TEST_F(ImagingTest, FindsBlurredMarkersFromANearOne) {
  constexpr double kBlur = 2.0;
  constexpr int kTrials = 16;
  LocalizerConfig config;
  config.estimation.blur = kBlur;
  map_.markers.clear();
  for (int i = 0; i < 5; ++i) {
    const double direction = 1.2 * i;
    const double distance = i == 0 ? 2.2 : 3.6 + 0.2 * i;
    map_.markers.push_back(test::wallMarker(
        3 * i, {distance * std::cos(direction), distance * std::sin(direction), 0.9 + 0.1 * i},
        direction + kPi));
    map_.markers.back().size = 0.75;
  }
  const Eigen::Vector3d deviations(0.033, 0.033, radians(2.5));
  int with_others = 0;
  for (int i = 0; i < kTrials; ++i) {
    Localizer localizer(camera_, map_, config);
    const Pose truth{0.02 * i - 0.15, 0.1 - 0.02 * i, 0.4 * i};
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    const Pose predicted{truth.x + 0.03, truth.y - 0.03 * side, truth.yaw + 0.04 * side};
    localizer.setPose(floorEstimate(predicted, deviations.cwiseAbs2().asDiagonal()));
    const FrameResult result =
        localizer.process({kMoment, blurredImage(truth, kBlur), mounting_, std::nullopt});
    with_others += result.acceptedMarkers() >= 3 && errorOf(result, truth) < 5e-3 ? 1 : 0;
  }
  EXPECT_GE(with_others, 11);
}

TEST_F(ImagingTest, RowsAreSeenAtTheirOwnTime) {
  BaseMotion motion;
  motion.velocity << 0.8, 0.0, 1.2, 0.0, 0.0, 0.0;
  constexpr double kRowTime = 5e-5;
  LocalizerConfig config;
  config.shutter.row_readout_time = kRowTime;
  for (const bool is_known : {true, false}) {
    Localizer localizer(camera_, map_, is_known ? config : LocalizerConfig());
    const Pose truth{0.2, -0.1, 0.4};
    localizer.setPose(truth);
    Frame frame{kMoment, rollingImage(truth, motion, kRowTime), mounting_, truth};
    frame.velocity = motion.velocity;
    const FrameResult result = localizer.process(frame);
    // If the readout time is not known, the pose is off by the robot's motion in half of it: 10 mm
    // and more.
    if (is_known) {
      EXPECT_LT(errorOf(result, truth), 2e-3);
    } else {
      EXPECT_GT(errorOf(result, truth), 8e-3);
    }
  }
}

TEST(ImageLagTest, IsFoundInTurnsAndNotInNoise) {
  std::mt19937 generator(4);
  std::normal_distribution<double> noise(0.0, 5e-4);
  for (const double lag : {0.0, 0.012, -0.02}) {
    ImageLag images;
    double last = 0.0;
    for (int i = 0; i < 60; ++i) {
      PoseVector velocity = PoseVector::Zero();
      velocity[2] = std::sin(0.4 * i);
      images.add(lag * (velocity[2] - last) + noise(generator), velocity, i > 0);
      last = velocity[2];
    }
    EXPECT_EQ(images.lag().has_value(), lag != 0.0);
    if (images.lag()) {
      EXPECT_NEAR(*images.lag(), lag, 1e-3);
    }
  }
}

TEST(ImageExposureTest, IsToldByTheGreyLevels) {
  cv::Mat image(200, 200, CV_8UC1);
  cv::theRNG().state = 1;
  const auto of = [&image](double low, double high) {
    cv::randu(image, low, high);
    return exposureOf(image);
  };
  EXPECT_EQ(of(0, 255), ImageExposure::kGood);
  EXPECT_EQ(of(20, 120), ImageExposure::kGood);
  EXPECT_EQ(of(0, 40), ImageExposure::kTooDark);
  EXPECT_EQ(of(251, 256), ImageExposure::kTooBright);
  EXPECT_EQ(of(120, 145), ImageExposure::kWashedOut);
}

}  // namespace
}  // namespace omnitag
