#include "photometry/photometric_refinement.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <utility>
#include <vector>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "photometry/lasting_disagreement.h"

namespace omnitag {
namespace {

/// Six markers of a room that all hang within 4 m of the robot, and what its camera sees of them.
class PhotometricRefinementTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    panorama_ = test::renderPanorama(sampleMap(), camera(), truth(), 6);
  }

  static void TearDownTestSuite() { panorama_.release(); }

  static MarkerMap sampleMap() {
    return {"map",
            {test::wallMarker(0, {3.2, -0.6, 1.2}, kPi), test::wallMarker(1, {2.1, 2.3, 1.5}, -2.3),
             test::wallMarker(2, {-0.7, 2.9, 1.0}, -kPi / 2),
             test::wallMarker(3, {-2.8, 0.3, 1.4}, 0.1, radians(20.0)),
             test::wallMarker(4, {-1.5, -2.4, 1.1}, 0.9),
             test::wallMarker(5, {1.2, -2.9, 1.3}, kPi / 2)}};
  }
  static MountedCamera camera() { return {test::sphericalCamera(), test::lookingDown()}; }
  static Pose truth() { return {0.25, -0.15, 0.6}; }

  static std::vector<std::size_t> entries(std::size_t count) {
    std::vector<std::size_t> entries(count);
    std::iota(entries.begin(), entries.end(), 0U);
    return entries;
  }

  static std::optional<PhotometricFit> refine(const cv::Mat& panorama,
                                              const std::vector<std::size_t>& entries,
                                              const Pose& initial,
                                              const PosePrior& prior = PosePrior::upright(),
                                              const MarkerMap& map = sampleMap(),
                                              double lasting_excess = 1.0) {
    return refinePhotometrically(panorama, map, camera(), TagPatterns(map), entries, initial, prior,
                                 {}, 1, lasting_excess);
  }

  static double nees(const PhotometricFit& fit, const Pose& true_pose = truth()) {
    const Eigen::Vector3d error = difference(fit.map_from_base.pose, true_pose).head<3>();
    return error.dot(floorCovariance(fit.map_from_base).ldlt().solve(error));
  }

  static Pose off(double x, double y, double yaw) {
    return {truth().x + x, truth().y + y, truth().yaw + yaw};
  }

  static double positionError(const PhotometricFit& fit) {
    return test::positionError(fit.map_from_base.pose, truth());
  }

  static double deviationsBetween(const PhotometricFit& a, const PhotometricFit& b) {
    const Eigen::Vector3d apart = difference(a.map_from_base.pose, b.map_from_base.pose).head<3>();
    return std::sqrt(apart.dot(floorCovariance(b.map_from_base).ldlt().solve(apart)));
  }

  static cv::Mat withNoise(double deviation, unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal(0.0, deviation);
    cv::Mat noisy = panorama_.clone();
    for (int v = 0; v < noisy.rows; ++v) {
      for (int u = 0; u < noisy.cols; ++u) {
        auto& grey = noisy.at<std::uint8_t>(v, u);
        grey = cv::saturate_cast<std::uint8_t>(grey + normal(generator));
      }
    }
    return noisy;
  }

  /// Noise of this deviation, blurred by this many pixels.
  static cv::Mat withSmoothNoise(double deviation, double blur, unsigned seed) {
    cv::Mat noise(panorama_.size(), CV_32FC1);
    cv::RNG generator(1 + seed);
    generator.fill(noise, cv::RNG::NORMAL, 0.0, 2.0 * std::sqrt(kPi) * blur * deviation);
    cv::GaussianBlur(noise, noise, {}, blur);
    cv::Mat noisy;
    cv::add(panorama_, noise, noisy, cv::noArray(), CV_8UC1);
    return noisy;
  }

  /// The panorama with its parts displaced by this many pixels (standard deviation along either
  /// axis); parts `reach` pixels apart are displaced independently.
  static cv::Mat distorted(const cv::Mat& panorama, double deviation, double reach, unsigned seed) {
    cv::RNG generator(1 + seed);
    cv::Mat from_u(panorama.size(), CV_32FC1);
    cv::Mat from_v(panorama.size(), CV_32FC1);
    for (cv::Mat* const from : {&from_u, &from_v}) {
      generator.fill(*from, cv::RNG::NORMAL, 0.0, 2.0 * std::sqrt(kPi) * reach * deviation);
      cv::GaussianBlur(*from, *from, {}, reach);
    }
    for (int v = 0; v < panorama.rows; ++v) {
      for (int u = 0; u < panorama.cols; ++u) {
        from_u.at<float>(v, u) += static_cast<float>(u);
        from_v.at<float>(v, u) += static_cast<float>(v);
      }
    }
    cv::Mat distorted;
    cv::remap(panorama, distorted, from_u, from_v, cv::INTER_LANCZOS4);
    return distorted;
  }

  /// Paints over a marker between two x coordinates of its frame, in units of half its size.
  static void cover(cv::Mat* panorama, const Marker& marker, double left, double right) {
    std::vector<cv::Point> outline;
    for (const auto& [x, y] : {std::pair(left, -1.3), std::pair(right, -1.3), std::pair(right, 1.3),
                               std::pair(left, 1.3)}) {
      const Eigen::Vector3d point =
          marker.map_from_marker * (0.5 * marker.size * Eigen::Vector3d(x, y, 0.0));
      const Eigen::Vector2d pixel = *camera().pixelFromMap(truth(), point);
      outline.emplace_back(cvRound(pixel.x()), cvRound(pixel.y()));
    }
    cv::fillConvexPoly(*panorama, outline, cv::Scalar(90));
  }

  static cv::Mat panorama_;
};

cv::Mat PhotometricRefinementTest::panorama_;

TEST_F(PhotometricRefinementTest, ConvergesToTheTruePose) {
  for (int i = 0; i < 6; ++i) {
    const double direction = kPi / 3.0 * i;
    const double turn = radians(i % 2 == 0 ? 0.3 : -0.3);
    const Pose initial = off(0.005 * std::cos(direction), 0.005 * std::sin(direction), turn);
    const auto fit = refine(panorama_, entries(6), initial);
    ASSERT_TRUE(fit);
    EXPECT_LT(positionError(*fit), 3e-4);
    EXPECT_NEAR(fit->map_from_base.pose.yaw, truth().yaw, radians(0.01));
    ASSERT_EQ(fit->weights.size(), 6U);
    for (const double weight : fit->weights) EXPECT_GT(weight, 0.3);
  }
}

TEST_F(PhotometricRefinementTest, TheCovarianceShrinksWithEveryMarker) {
  const cv::Mat noisy = withNoise(2.0, 1);
  double last = std::numeric_limits<double>::infinity();
  for (const std::size_t count : {1U, 2U, 4U, 6U}) {
    const auto fit = refine(noisy, entries(count), off(0.002, -0.002, 0.002));
    ASSERT_TRUE(fit) << count;
    const double variance = fit->map_from_base.covariance.topLeftCorner<2, 2>().trace();
    EXPECT_LT(variance, last) << count;
    last = variance;
  }
}

TEST_F(PhotometricRefinementTest, TellsTheNoiseAndIsAsExactAsItSays) {
  for (const double deviation : {2.0, 5.0}) {
    constexpr int kTrials = 12;
    double mean_square = 0.0;
    for (unsigned i = 0; i < kTrials; ++i) {
      const auto fit = refine(withNoise(deviation, 10 + i), entries(6), off(0.003, 0.002, -0.003));
      ASSERT_TRUE(fit);
      EXPECT_NEAR(fit->noise, deviation, 0.25 * deviation);
      mean_square += nees(*fit) / kTrials;
    }
    // Chi-square with 3 degrees of freedom; the covariance allows for a map that is not exact.
    EXPECT_LT(mean_square, 4.5) << deviation;
    EXPECT_GT(mean_square, 0.2) << deviation;
  }
}

TEST_F(PhotometricRefinementTest, WhatManyMarkersDisagreeByIsKnownOfOne) {
  constexpr int kToLearn = 10;
  constexpr int kTrials = 60;
  LastingDisagreement lasting;
  double unaware = 0.0;
  double aware = 0.0;
  double of_many = 0.0;
  for (int i = 0; i < kToLearn + kTrials; ++i) {
    // Neighbouring pixels err alike, which a single one does not show.
    const cv::Mat image = withSmoothNoise(10.0, 2.0, static_cast<unsigned>(i));
    const auto many =
        refine(image, entries(6), truth(), PosePrior::upright(), sampleMap(), lasting.excess());
    ASSERT_TRUE(many);
    lasting.add(many->disagreement);
    if (i < kToLearn) continue;
    const std::vector<std::size_t> one{static_cast<std::size_t>(i % 6)};
    const auto fit = refine(image, one, truth());
    ASSERT_TRUE(fit);
    const auto fit_aware =
        refine(image, one, truth(), PosePrior::upright(), sampleMap(), lasting.excess());
    ASSERT_TRUE(fit_aware);
    unaware += nees(*fit) / kTrials;
    aware += nees(*fit_aware) / kTrials;
    of_many += nees(*many) / kTrials;
  }
  EXPECT_GT(unaware, 6.0);
  // Chi-square with 3 degrees of freedom.
  EXPECT_LT(aware, 4.5);
  EXPECT_GT(aware, 1.5);
  EXPECT_LT(of_many, 4.5);
  EXPECT_GT(of_many, 1.5);
}

TEST_F(PhotometricRefinementTest, IsAsExactAsItSaysBehindALensThatNoModeDescribes) {
  // A fisheye that looks ahead sees two markers on the floor, near its rim and tens of pixels wide.
  const auto lens = [](const std::string& uncertainty) {
    return parseCamera(
        "{model: equidistant, image: {width: 700, height: 700}, uncertainty: " + uncertainty +
            ", lens: {fx: 210, fy: 210, cx: 350, cy: 350},"
            " distortion: [0, 0, 0, 0], max_angle: 1.6}",
        "lens");
  };
  Eigen::Isometry3d ahead(Eigen::Translation3d(0.0, 0.0, 0.8));
  ahead.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  MarkerMap map{
      "map",
      {test::wallMarker(0, {0.5, 0.5, 0.0}, 0.0), test::wallMarker(1, {0.5, -0.4, 0.0}, 0.0)}};
  for (Marker& marker : map.markers) {
    marker.size = 0.2;
    marker.map_from_marker.linear() = Eigen::Matrix3d::Identity();
    marker.deviation = 0.005;
    marker.orientation_deviation = radians(1.0);
  }
  const cv::Mat ideal = test::renderPanorama(map, {lens("none"), ahead}, {}, 4);
  const MountedCamera camera(lens("{principal_point: 1, scale: 1, tilt: 1, rim: 1}"), ahead);
  // As large as the camera's uncertainty allows beside its modes, and different from one side of a
  // marker to the other.
  constexpr double kDistortion = 0.3;
  constexpr double kReach = 15.0;
  constexpr int kTrials = 30;
  double mean_nees = 0.0;
  double mean_square = 0.0;
  for (unsigned i = 0; i < kTrials; ++i) {
    const auto fit = refinePhotometrically(distorted(ideal, kDistortion, kReach, i), map, camera,
                                           TagPatterns(map), entries(2), {},
                                           PosePrior::standing({}, 0.005, radians(0.5)), {});
    ASSERT_TRUE(fit);
    mean_nees += nees(*fit, {}) / kTrials;
    mean_square += std::pow(test::positionError(fit->map_from_base.pose, {}), 2) / kTrials;
  }
  // If the shape of a marker's image counts as exact, what distorts it moves the pose by 10 mm.
  EXPECT_LT(std::sqrt(mean_square), 0.005);
  // Chi-square with 3 degrees of freedom; the draws have no errors of the map or the modes.
  EXPECT_LT(mean_nees, 3.0);
}

TEST_F(PhotometricRefinementTest, ThePoseIsTheSameFromNearAndFar) {
  // Edges are displaced by a hundredth of a pixel to some tenths.
  for (const std::size_t count : {1U, 2U, 3U, 6U}) {
    for (unsigned seed = 20; seed < 24; ++seed) {
      const cv::Mat noisy = withNoise(2.0, seed);
      const auto expected = refine(noisy, entries(count), truth());
      ASSERT_TRUE(expected) << count;
      for (const double distance : {0.0005, 0.001, 0.0015, 0.002, 0.004}) {
        const double direction = 1.7 * seed;
        const auto fit = refine(noisy, entries(count),
                                off(distance * std::cos(direction), distance * std::sin(direction),
                                    (seed % 2 == 0 ? 0.3 : -0.3) * distance));
        ASSERT_TRUE(fit) << count;
        EXPECT_LT(deviationsBetween(*fit, *expected), 1.0) << count << ", " << distance << " m";
      }
    }
  }
}

TEST_F(PhotometricRefinementTest, IsAsExactAsItSaysFromNearStarts) {
  std::mt19937 generator(40);
  std::normal_distribution<double> normal;
  for (const double deviation : {0.0003, 0.001}) {
    constexpr int kTrials = 20;
    double mean_square = 0.0;
    for (unsigned i = 0; i < kTrials; ++i) {
      const double x = deviation * normal(generator);
      const double y = deviation * normal(generator);
      const double yaw = 0.3 * deviation * normal(generator);
      const auto fit = refine(withNoise(2.0, 50 + i), entries(6), off(x, y, yaw));
      ASSERT_TRUE(fit);
      const Eigen::Vector3d error = difference(fit->map_from_base.pose, truth()).head<3>();
      mean_square += error.dot(floorCovariance(fit->map_from_base).ldlt().solve(error)) / kTrials;
    }
    EXPECT_LT(mean_square, 4.5) << deviation;
  }
}

TEST_F(PhotometricRefinementTest, ThePoseIsTheSameFromAllAroundAMarker) {
  // A marker looks hardly different from a little farther left or right.
  const cv::Mat noisy = withNoise(2.0, 30);
  for (const std::size_t entry : {0U, 2U, 5U}) {
    const auto expected = refine(noisy, {entry}, truth());
    ASSERT_TRUE(expected);
    for (const double turn : {-0.03, -0.015, 0.015, 0.03}) {
      const Eigen::Vector2d center = sampleMap().markers[entry].center().head<2>();
      const Eigen::Vector2d base =
          center + Eigen::Rotation2Dd(turn) * (Eigen::Vector2d(truth().x, truth().y) - center);
      const auto fit = refine(noisy, {entry}, {base.x(), base.y(), truth().yaw + turn});
      ASSERT_TRUE(fit) << entry << ", " << turn;
      EXPECT_LT(deviationsBetween(*fit, *expected), 1.0) << entry << ", " << turn;
    }
  }
}

TEST_F(PhotometricRefinementTest, AHalfCoveredMarkerHardlyPullsThePose) {
  for (const std::size_t covered : {0U, 2U, 4U}) {
    cv::Mat panorama = panorama_.clone();
    cover(&panorama, sampleMap().markers[covered], -1.3, 0.0);
    for (const Pose& initial : {truth(), off(0.003, 0.002, -0.003)}) {
      const auto fit = refine(panorama, entries(6), initial);
      ASSERT_TRUE(fit) << covered;
      EXPECT_LT(positionError(*fit), 1e-3) << covered;
      EXPECT_NEAR(fit->map_from_base.pose.yaw, truth().yaw, radians(0.05)) << covered;
    }
  }
}

TEST_F(PhotometricRefinementTest, AMarkerThatHangsElsewhereCountsLittle) {
  for (const std::size_t moved : {0U, 3U}) {
    MarkerMap wrong = sampleMap();
    wrong.markers[moved].map_from_marker.translate(Eigen::Vector3d(0.02, 0.0, 0.0));
    const auto fit =
        refine(panorama_, entries(6), off(0.002, 0.002, -0.002), PosePrior::upright(), wrong);
    ASSERT_TRUE(fit) << moved;
    for (std::size_t i = 0; i < 6; ++i) {
      if (i == moved) {
        EXPECT_LT(fit->weights[i], 0.1);
      } else {
        EXPECT_GT(fit->weights[i], 2.0 * fit->weights[moved]);
      }
    }
    EXPECT_LT(positionError(*fit), 2e-3) << moved;
  }
}

TEST_F(PhotometricRefinementTest, AnImageWithoutPatternsGivesNothing) {
  for (const double grey : {0.0, 120.0, 255.0}) {
    const cv::Mat even(panorama_.size(), CV_8UC1, cv::Scalar(grey));
    EXPECT_FALSE(refine(even, entries(6), truth())) << grey;
  }
  EXPECT_FALSE(refine(panorama_, {}, truth()));
  // What is white should be black.
  const cv::Mat negative = 255 - panorama_;
  EXPECT_FALSE(refine(negative, entries(6), truth()));
}

TEST_F(PhotometricRefinementTest, ThePriorDecidesWhatOneMarkerLeavesOpen) {
  const cv::Mat noisy = withNoise(3.0, 2);
  PoseEstimate prior{off(0.004, -0.003, 0.002)};
  for (const double deviation : {1e-5, 5e-3}) {
    prior.covariance.diagonal().head<3>() << deviation * deviation, deviation * deviation,
        deviation * deviation;
    const auto fit = refine(noisy, {2}, off(0.003, -0.004, 0.001), PosePrior::about(prior));
    ASSERT_TRUE(fit);
    const Eigen::Vector3d error = difference(fit->map_from_base.pose, truth()).head<3>();
    const Eigen::Vector3d change = difference(fit->map_from_base.pose, prior.pose).head<3>();
    if (deviation < 1e-4) {
      EXPECT_LT(change.norm(), 2e-4) << "a certain prior stays";
    } else {
      EXPECT_LT(error.dot(floorCovariance(fit->map_from_base).ldlt().solve(error)), 16.3);
    }
    // The marker adds to what the prior knows.
    const Eigen::Matrix3d gained = floorCovariance(prior) - floorCovariance(fit->map_from_base);
    EXPECT_GT(gained.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(),
              -1e-6 * prior.covariance(0, 0));
  }
}

}  // namespace
}  // namespace omnitag
