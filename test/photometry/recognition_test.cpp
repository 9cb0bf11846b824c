#include "photometry/recognition.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "../support/sweep.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// The camera of test::sphericalCamera() with its principal point elsewhere: what it sees is the
/// same, moved across the image.
MountedCamera movedCamera(const Eigen::Vector2d& shift) {
  const std::string center =
      "cx: " + std::to_string(249.5 + shift.x()) + ", cy: " + std::to_string(249.5 + shift.y());
  return {parseCamera("model: catadioptric\n"
                      "image: {width: 500, height: 500}\nuncertainty: none\n"
                      "lens: {fx: 1234, fy: 1234, " +
                          center +
                          "}\n"
                          "mirror: {profile: spherical, radius_of_curvature: 0.04, "
                          "apex_distance: 0.21, rim_radius: 0.0395}\n",
                      "sphere"),
          test::lookingDown()};
}

Pose truth() { return {0.25, -0.15, 0.6}; }

/// A marker 3 m from the origin, turned away from it.
Marker markerAt(double direction, double incidence, const std::string& family = "tag36h11",
                int id = 42) {
  Marker marker = test::wallMarker(id, {3.0 * std::cos(direction), 3.0 * std::sin(direction), 1.25},
                                   direction + kPi + incidence);
  marker.family = family;
  return marker;
}

/// The same, so large that its modules image this many pixels wide along the tangent.
Marker withModulesOf(double pixels, Marker marker) {
  const MountedCamera camera = movedCamera({0.0, 0.0});
  constexpr double kStep = 0.01;  // m
  const auto imageOf = [&](double x) {
    return *camera.pixelFromMap(truth(), marker.map_from_marker * Eigen::Vector3d(x, 0.0, 0.0));
  };
  const double pixels_per_metre = (imageOf(kStep) - imageOf(-kStep)).norm() / (2.0 * kStep);
  marker.size =
      pixels * test::tagBitmap(marker.family, marker.id).width_at_border / pixels_per_metre;
  return marker;
}

cv::Mat imageOf(const Marker& marker, const Eigen::Vector2d& shift = {0.0, 0.0}) {
  return test::renderPanorama({"map", {marker}}, movedCamera(shift), truth(), 5);
}

cv::Mat withNoise(const cv::Mat& image, double deviation, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, deviation);
  cv::Mat noisy = image.clone();
  for (int v = 0; v < noisy.rows; ++v) {
    for (int u = 0; u < noisy.cols; ++u) {
      auto& grey = noisy.at<std::uint8_t>(v, u);
      grey = cv::saturate_cast<std::uint8_t>(grey + normal(generator));
    }
  }
  return noisy;
}

/// Looks for a marker within `margin` pixels of its predicted place, by the pattern of any tag.
std::optional<Recognition> recognizeAs(const TagPattern& pattern, const cv::Mat& image,
                                       const Marker& marker, double margin = 3.0,
                                       const RecognitionConfig& config = {},
                                       const ImageBlur& blur = {}) {
  const MountedCamera camera = movedCamera({0.0, 0.0}).withBlur(blur);
  PoseEstimate pose;
  pose.pose = truth();
  VisibilityConfig visibility;
  visibility.min_edge_pixels = 0.0;
  auto predicted = predictMarker({"map", {marker}}, 0, camera, pose, visibility);
  if (!predicted) throw InputError("the marker is out of sight");
  predicted->tangential_margin = margin;
  predicted->radial_margin = margin;
  return recognize(image, marker, pattern, camera, truth(), *predicted, config);
}

std::optional<Recognition> recognizeIn(const cv::Mat& image, const Marker& marker,
                                       double margin = 3.0, const RecognitionConfig& config = {}) {
  return recognizeAs({marker.family, marker.id}, image, marker, margin, config);
}

bool isAccepted(const std::optional<Recognition>& recognition) {
  return recognition && recognition->is_accepted;
}

std::string describe(const std::optional<Recognition>& recognition) {
  if (!recognition) return "nothing";
  return "correlation " + std::to_string(recognition->correlation) + ", threshold " +
         std::to_string(recognition->threshold);
}

/// Pixels of the panorama by which a marker is away from where it is predicted.
Eigen::Vector2d displacementOf(const Recognition& recognition, const Marker& marker) {
  return recognition.center - *movedCamera({0.0, 0.0}).pixelFromMap(truth(), marker.center());
}

void expectFound(const Marker& marker, const Eigen::Vector2d& shift) {
  const auto recognition = recognizeIn(imageOf(marker, shift), marker);
  ASSERT_TRUE(isAccepted(recognition)) << describe(recognition);
  EXPECT_LT((displacementOf(*recognition, marker) - shift).norm(), 0.05);
}

TEST(RecognitionTest, FindsADisplacedMarkerToATwentiethOfAPixel) {
  for (const double module : {1.5, 2.0, 3.0, 5.0, 7.0}) {
    for (const double incidence : {0.0, 30.0, -60.0}) {
      SCOPED_TRACE(std::to_string(module) + " pixels per module at " + std::to_string(incidence) +
                   " degrees");
      const auto markerTowards = [&](double direction) {
        return withModulesOf(module, markerAt(direction, radians(incidence)));
      };
      expectFound(markerTowards(0.4), {0.3, -0.7});
      expectFound(markerTowards(2.4), {2.4, 1.3});
      expectFound(markerTowards(4.4), {-1.5, 2.2});
    }
  }
}

TEST(RecognitionTest, FindsTheCornersOfAMarkerThatLooksOtherwiseThanPredicted) {
  constexpr double kSize = 0.5;  // m
  const MountedCamera camera(test::largeSphericalCamera(), test::lookingDown());
  const Pose predicted_pose{truth().x + 0.03, truth().y - 0.02, truth().yaw + radians(0.5)};
  // m; modules are 4, 7 and 14 pixels wide.
  for (const double range : {3.0, 1.8, 1.1}) {
    Marker marker = test::wallMarker(
        42, {truth().x + range * std::cos(2.0), truth().y + range * std::sin(2.0), 1.25},
        2.0 + kPi + radians(20.0));
    marker.size = kSize;
    const MarkerMap map{"map", {marker}};
    const cv::Mat image = test::renderPanorama(map, camera, truth(), 5);
    PoseEstimate belief{predicted_pose};
    belief.covariance.diagonal().head<3>() << 4e-4, 4e-4, 8e-5;
    const auto predicted = predictMarker(map, 0, camera, belief, {});
    ASSERT_TRUE(predicted) << range;
    const auto recognition = recognize(image, marker, TagPattern(marker.family, marker.id), camera,
                                       predicted_pose, *predicted, {});
    ASSERT_TRUE(isAccepted(recognition)) << range << ": " << describe(recognition);
    double off_prediction = 0.0;
    for (std::size_t k = 0; k < recognition->corners.size(); ++k) {
      const Eigen::Vector2d corner = *camera.pixelFromMap(truth(), marker.corners()[k]);
      EXPECT_LT((recognition->corners[k] - corner).norm(), 0.5) << range << ", corner " << k;
      const Eigen::Vector2d displaced =
          predicted->corners[k] + recognition->center - predicted->center;
      off_prediction = std::max(off_prediction, (displaced - corner).norm());
    }
    RecordProperty("displaced_alone_" + std::to_string(range), std::to_string(off_prediction));
  }
}

TEST(RecognitionTest, NoiseHardlyMatters) {
  for (const double module : {1.5, 3.0, 7.0}) {
    const Marker marker = withModulesOf(module, markerAt(1.1, radians(20.0)));
    const Eigen::Vector2d shift(1.3, -1.8);
    const cv::Mat image = imageOf(marker, shift);
    double squares = 0.0;
    constexpr int kTrials = 20;
    for (unsigned seed = 0; seed < kTrials; ++seed) {
      const auto recognition = recognizeIn(withNoise(image, 8.0, seed), marker);
      ASSERT_TRUE(isAccepted(recognition)) << module << ": " << describe(recognition);
      squares += (displacementOf(*recognition, marker) - shift).squaredNorm() / kTrials;
    }
    EXPECT_LT(std::sqrt(squares), 0.1) << module;
  }
}

TEST(RecognitionTest, FindsMarkersOfAllLayouts) {
  const Eigen::Vector2d shift(-1.3, 0.6);
  for (const char* family : {"tag36h11", "tag16h5", "tagCircle21h7", "tagStandard41h12"}) {
    const Marker marker = withModulesOf(4.0, markerAt(2.0, radians(20.0), family, 7));
    const auto recognition = recognizeIn(imageOf(marker, shift), marker);
    ASSERT_TRUE(isAccepted(recognition)) << family << ": " << describe(recognition);
    EXPECT_LT((displacementOf(*recognition, marker) - shift).norm(), 0.1) << family;
  }
}

TEST(RecognitionTest, NoOtherTagOfTheFamilyIsTakenForIt) {
  for (const double module : {1.5, 4.0}) {
    for (const int id : {0, 42, 586}) {
      const Marker marker =
          withModulesOf(module, markerAt(0.3 + id, radians(id == 42 ? 45.0 : 0.0), "tag36h11", id));
      const cv::Mat image = imageOf(marker);
      for (int other = 0; other < 587; other += test::kSweepStride) {
        const auto recognition = recognizeAs({"tag36h11", other}, image, marker);
        EXPECT_EQ(isAccepted(recognition), other == id)
            << id << " as " << other << ": " << describe(recognition);
      }
    }
  }
}

TEST(RecognitionTest, NoOtherTagOfASmallFamilyIsTakenForIt) {
  for (const int id : {0, 17, 29}) {
    const Marker marker = withModulesOf(3.0, markerAt(0.3 + id, 0.0, "tag16h5", id));
    const cv::Mat image = imageOf(marker);
    for (int other = 0; other < 30; ++other) {
      const auto recognition = recognizeAs({"tag16h5", other}, image, marker);
      EXPECT_EQ(isAccepted(recognition), other == id)
          << id << " as " << other << ": " << describe(recognition);
    }
  }
}

TEST(RecognitionTest, ARolledTagIsAnother) {
  for (const double module : {1.5, 4.0}) {
    for (const int id : {0, 42, 123}) {
      const Marker marker = withModulesOf(module, markerAt(0.9, radians(25.0), "tag36h11", id));
      for (const double roll : {90.0, 180.0, 270.0}) {
        Marker rolled = marker;
        rolled.map_from_marker.rotate(Eigen::AngleAxisd(radians(roll), Eigen::Vector3d::UnitZ()));
        const cv::Mat image = imageOf(rolled);
        const auto recognition = recognizeIn(image, marker);
        EXPECT_FALSE(isAccepted(recognition)) << roll << ": " << describe(recognition);
        EXPECT_TRUE(isAccepted(recognizeIn(image, rolled)));
      }
    }
  }
}

TEST(RecognitionTest, AMirroredTagIsAnother) {
  // The marker lies straight ahead on the camera's u axis, so that mirroring keeps its place.
  const MountedCamera camera(test::sphericalCamera(),
                             Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 1.1) *
                                               Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX())));
  const PoseEstimate estimate;
  const Pose pose = estimate.pose;
  for (const int id : {0, 42, 123}) {
    for (const double size : {0.4, 0.8}) {
      MarkerMap map{"map", {test::wallMarker(id, {3.0, 0.0, 1.25}, kPi)}};
      map.markers[0].size = size;
      const cv::Mat image = test::renderPanorama(map, camera, pose, 5);
      cv::Mat mirrored;
      cv::flip(image, mirrored, 0);
      const auto predicted = predictMarker(map, 0, camera, estimate, {});
      ASSERT_TRUE(predicted);
      const auto look = [&](const cv::Mat& panorama) {
        return recognize(panorama, map.markers[0], {"tag36h11", id}, camera, pose, *predicted, {});
      };
      ASSERT_TRUE(isAccepted(look(image))) << describe(look(image));
      EXPECT_FALSE(isAccepted(look(mirrored))) << describe(look(mirrored));
    }
  }
}

TEST(RecognitionTest, WhatIsWhiteMustNotBeBlack) {
  for (const double module : {1.5, 4.0}) {
    const Marker marker = withModulesOf(module, markerAt(0.9, radians(25.0)));
    const cv::Mat negative = 250 - imageOf(marker);
    const auto recognition = recognizeIn(negative, marker);
    EXPECT_FALSE(isAccepted(recognition)) << describe(recognition);
  }
}

TEST(RecognitionTest, ABlankWallIsNoMarker) {
  for (const double module : {1.5, 4.0}) {
    const Marker marker = withModulesOf(module, markerAt(0.9, 0.0));
    for (const double grey : {0.0, 120.0, 255.0}) {
      EXPECT_FALSE(isAccepted(recognizeIn(cv::Mat(500, 500, CV_8UC1, cv::Scalar(grey)), marker)));
    }
    cv::Mat slope(500, 500, CV_8UC1);
    for (int v = 0; v < slope.rows; ++v) {
      for (int u = 0; u < slope.cols; ++u) {
        slope.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(0.2 * u + 0.3 * v);
      }
    }
    EXPECT_FALSE(isAccepted(recognizeIn(slope, marker)));
    EXPECT_FALSE(isAccepted(recognizeIn(withNoise(slope, 20.0, 1), marker)));
  }
}

/// Random spots of about a module across.
cv::Mat texture(double spot, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<float> normal;
  cv::Mat noise(500, 500, CV_32FC1);
  for (int v = 0; v < noise.rows; ++v) {
    for (int u = 0; u < noise.cols; ++u) noise.at<float>(v, u) = normal(generator);
  }
  cv::GaussianBlur(noise, noise, cv::Size(), spot, spot);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(noise, mean, deviation);
  cv::Mat image;
  noise.convertTo(image, CV_8UC1, 60.0 / deviation[0], 125.0);
  return image;
}

/// How many of 1000 markers are accepted in random textures.
int acceptedInTextures(double module, double spot, const RecognitionConfig& config) {
  int accepted = 0;
  for (unsigned seed = 0; seed < 40; seed += test::kSweepStride) {
    const cv::Mat image = texture(spot, seed);
    for (int i = 0; i < 25; ++i) {
      const Marker marker = withModulesOf(module, markerAt(0.25 * i, 0.0, "tag36h11", 20 * i));
      accepted += isAccepted(recognizeIn(image, marker, 3.0, config)) ? 1 : 0;
    }
  }
  return accepted;
}

TEST(RecognitionTest, RandomTexturesAreTakenForAMarkerNoMoreOftenThanConfigured) {
  if (test::kIsSanitized) GTEST_SKIP() << test::kRepeats;
  RecognitionConfig lax;
  lax.false_accept_rate = 0.01;
  for (const double module : {1.5, 3.0}) {
    for (const double spot : {0.3 * module, 0.6 * module}) {
      EXPECT_EQ(acceptedInTextures(module, spot, {}), 0) << module << ", " << spot;
      // At most four standard deviations more than expected.
      EXPECT_LT(acceptedInTextures(module, spot, lax), 10.0 + 4.0 * std::sqrt(10.0))
          << module << ", " << spot;
    }
  }
}

/// Paints over a marker between two x coordinates of its frame, in units of half its size.
void cover(cv::Mat* panorama, const Marker& marker, double left, double right, double grey) {
  std::vector<cv::Point> outline;
  for (const auto& [x, y] : {std::pair(left, -1.3), std::pair(right, -1.3), std::pair(right, 1.3),
                             std::pair(left, 1.3)}) {
    const Eigen::Vector3d point =
        marker.map_from_marker * (0.5 * marker.size * Eigen::Vector3d(x, y, 0.0));
    const Eigen::Vector2d pixel = *movedCamera({0.0, 0.0}).pixelFromMap(truth(), point);
    outline.emplace_back(cvRound(pixel.x()), cvRound(pixel.y()));
  }
  cv::fillConvexPoly(*panorama, outline, cv::Scalar(grey));
}

TEST(RecognitionTest, AHalfCoveredMarkerIsNotRecognized) {
  for (const double module : {1.5, 2.0, 4.0}) {
    for (const int id : {0, 42, 300}) {
      const Marker marker = withModulesOf(module, markerAt(2.2, 0.0, "tag36h11", id));
      for (const double grey : {30.0, 120.0, 220.0}) {
        cv::Mat image = imageOf(marker);
        cover(&image, marker, -1.3, 0.0, grey);
        const auto recognition = recognizeIn(image, marker);
        EXPECT_FALSE(isAccepted(recognition))
            << module << ", " << id << ", " << grey << ": " << describe(recognition);
      }
    }
  }
}

TEST(RecognitionTest, AMarkerWithACoveredEdgeIsRecognized) {
  const Marker marker = withModulesOf(4.0, markerAt(2.2, 0.0));
  cv::Mat image = imageOf(marker);
  cover(&image, marker, -1.3, -0.7, 120.0);
  const auto recognition = recognizeIn(image, marker);
  ASSERT_TRUE(isAccepted(recognition)) << describe(recognition);
  EXPECT_LT(displacementOf(*recognition, marker).norm(), 0.3);
}

TEST(RecognitionTest, APaleMarkerIsNone) {
  const Marker marker = withModulesOf(4.0, markerAt(2.2, 0.0));
  const cv::Mat image = imageOf(marker);
  const auto withContrast = [&](double contrast) {
    cv::Mat pale;
    image.convertTo(pale, CV_8UC1, contrast / 190.0, 100.0 - 30.0 * contrast / 190.0);
    return pale;
  };
  const RecognitionConfig config;
  EXPECT_TRUE(isAccepted(recognizeIn(withContrast(config.min_contrast + 2.0), marker)));
  EXPECT_FALSE(recognizeIn(withContrast(config.min_contrast - 2.0), marker));
}

/// Pixels, the mean length of a module.
double moduleOf(const Marker& marker) {
  const MountedCamera camera = movedCamera({0.0, 0.0});
  Corners<Eigen::Vector2d> corners;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    corners[k] = *camera.pixelFromMap(truth(), marker.corners()[k]);
  }
  return meanEdge(corners) / test::tagBitmap(marker.family, marker.id).width_at_border;
}

TEST(RecognitionTest, AVaguePredictionGivesNothing) {
  const Marker marker = withModulesOf(4.0, markerAt(2.2, 0.0));
  const cv::Mat image = imageOf(marker);
  RecognitionConfig config;
  const double limit = config.max_margin * moduleOf(marker);
  ASSERT_GT(limit, 7.0);
  EXPECT_TRUE(isAccepted(recognizeIn(image, marker, 0.99 * limit)));
  EXPECT_FALSE(recognizeIn(image, marker, 1.01 * limit));
  config.max_margin *= 1.02;
  EXPECT_TRUE(isAccepted(recognizeIn(image, marker, 1.01 * limit, config)));
}

TEST(RecognitionTest, BlurMakesTheMarginLarger) {
  // Too much for a decoder to read the marker.
  constexpr double kBlur = 2.0;  // pixels
  const Marker marker = withModulesOf(3.5, markerAt(2.2, 0.0));
  RecognitionConfig config;
  config.max_margin = 5.0;
  const double margin = 1.3 * config.max_margin * moduleOf(marker);
  const Eigen::Vector2d shift = 0.6 * margin * Eigen::Vector2d(0.8, -0.6);
  cv::Mat image = imageOf(marker, shift);
  cv::GaussianBlur(image, image, {}, kBlur);
  const TagPattern pattern(marker.family, marker.id);
  EXPECT_FALSE(recognizeAs(pattern, image, marker, margin, config));
  const auto found = recognizeAs(pattern, image, marker, margin, config, {kBlur * kBlur});
  ASSERT_TRUE(isAccepted(found)) << describe(found);
  EXPECT_LT((displacementOf(*found, marker) - shift).norm(), 0.2);
}

TEST(RecognitionTest, FindsAMarkerAnywhereWithinItsMargin) {
  const Marker marker = withModulesOf(4.0, markerAt(2.2, radians(30.0)));
  const MountedCamera camera = movedCamera({0.0, 0.0});
  const Eigen::Vector2d radial = (*camera.pixelFromMap(truth(), marker.center()) -
                                  camera.model().imagePlane().principalPoint())
                                     .normalized();
  const Eigen::Vector2d tangential(-radial.y(), radial.x());
  for (const auto& [along_tangent, along_radius] :
       {std::pair(7.0, -7.0), std::pair(-6.4, 3.2), std::pair(0.4, 6.7)}) {
    const Eigen::Vector2d shift = along_tangent * tangential + along_radius * radial;
    const auto recognition = recognizeIn(imageOf(marker, shift), marker, 7.0);
    ASSERT_TRUE(isAccepted(recognition)) << shift.transpose() << ": " << describe(recognition);
    EXPECT_LT((displacementOf(*recognition, marker) - shift).norm(), 0.1) << shift.transpose();
  }
}

TEST(RecognitionTest, FindsAMarkerThatARobotsTurnTookFarAside) {
  // Its image is turned, too.
  const Marker marker = withModulesOf(4.0, markerAt(2.2, radians(20.0)));
  const MountedCamera camera = movedCamera({0.0, 0.0});
  const Eigen::Vector2d expected = *camera.pixelFromMap(truth(), marker.center());
  const double radius = (expected - camera.model().imagePlane().principalPoint()).norm();
  RecognitionConfig config;
  config.max_margin = 15.0;
  for (const double turn : {-0.28, -0.15, 0.2, 0.28}) {
    SCOPED_TRACE(turn);
    Pose turned = truth();
    turned.yaw += turn;
    const cv::Mat image = test::renderPanorama({"map", {marker}}, camera, turned, 5);
    const auto recognition = recognizeIn(image, marker, 0.3 * radius, config);
    ASSERT_TRUE(isAccepted(recognition)) << describe(recognition);
    const Eigen::Vector2d place = *camera.pixelFromMap(turned, marker.center());
    EXPECT_GT((place - expected).norm(), 10.0);
    // Its shape differs there, too, not only its roll.
    EXPECT_LT((recognition->center - place).norm(), 0.3);
  }
}

TEST(RecognitionTest, AMarkerBeyondItsMarginIsNotFound) {
  const Marker marker = withModulesOf(4.0, markerAt(2.2, 0.0));
  EXPECT_FALSE(isAccepted(recognizeIn(imageOf(marker, {9.0, 9.0}), marker, 3.0)));
}

}  // namespace
}  // namespace omnitag
