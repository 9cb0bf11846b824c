#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "../support/level_floor.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "../support/sweep.h"
#include "localization/displacement.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

constexpr double kPeriod = 0.1;  // s between frames

/// A robot among seven markers that are not all as the map says.
class OddMarkersTest : public testing::Test {
 protected:
  static Marker ringMarker(int id, double direction, double height) {
    return test::wallMarker(id, {3.5 * std::cos(direction), 3.5 * std::sin(direction), height},
                            direction + kPi);
  }

  static double direction(int index) { return 2.0 * kPi * index / 7 + 0.15 * (index % 2); }

  static MarkerMap ring() {
    MarkerMap map;
    for (int i = 0; i < 7; ++i) {
      map.markers.push_back(ringMarker(3 * i, direction(i), 1.0 + 0.08 * i));
    }
    return map;
  }

  /// The markers after three neighbours were moved as one, like a shelf.
  MarkerMap afterMoving(std::size_t first, const Eigen::Isometry3d& motion) const {
    MarkerMap seen = map_;
    for (std::size_t k = 0; k < 3; ++k) {
      Marker& moved = seen.markers[(first + k) % seen.markers.size()];
      moved.map_from_marker = motion * moved.map_from_marker;
    }
    return seen;
  }

  cv::Mat render(const MarkerMap& seen) const {
    return test::renderPanorama(seen, {model_, mounting_}, truth_);
  }

  FrameResult process(const cv::Mat& image) {
    const FrameResult result =
        localizer_.process({kPeriod * frames_++, image, mounting_, std::nullopt});
    log_.add(result);
    return result;
  }

  /// Expects the true pose, and a reason for every rejection.
  void expectSound(const FrameResult& result) const {
    ASSERT_TRUE(result.map_from_base) << result.remark;
    EXPECT_LT(test::positionError(result.map_from_base->pose, truth_), 3e-3);
    EXPECT_NEAR(result.map_from_base->pose.yaw, truth_.yaw, 1e-3);
    for (const MarkerDetection& detection : result.detections) {
      EXPECT_EQ(detection.accepted, detection.reason.empty()) << detection.id << detection.reason;
    }
  }

  /// Shows an image to a robot that knows its pose, for some seconds.
  void watch(const cv::Mat& image, double seconds) {
    localizer_.setPose(truth_);
    for (double time = 0.0; time < seconds; time += kPeriod) {
      const FrameResult result = process(image);
      expectSound(result);
      EXPECT_EQ(result.mode, Mode::kTracking);
      for (const MarkerDetection& detection : result.detections) {
        if (!detection.accepted) rejected_.push_back(detection);
      }
    }
  }

  /// Shows an image to a robot that does not know its pose.
  FrameResult search(const cv::Mat& image) {
    FrameResult result = process(image);
    expectSound(result);
    EXPECT_EQ(result.mode, result.map_from_base ? Mode::kFound : Mode::kSearching);
    return result;
  }

  static int acceptedOf(const FrameResult& result, int id) {
    return static_cast<int>(
        std::count_if(result.detections.begin(), result.detections.end(),
                      [id](const MarkerDetection& d) { return d.id == id && d.accepted; }));
  }

  bool wasRejected(int id, const std::string& reason) const {
    return std::any_of(rejected_.begin(), rejected_.end(), [&](const MarkerDetection& d) {
      return d.id == id && d.reason.find(reason) != std::string::npos;
    });
  }

  std::shared_ptr<const CameraModel> model_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
  Pose truth_{0.25, -0.15, 0.6};
  MarkerMap map_ = ring();
  Localizer localizer_{model_, map_, test::onLevelFloor()};
  DisplacementLog log_;
  int frames_ = 0;
  std::vector<MarkerDetection> rejected_;
};

TEST_F(OddMarkersTest, OneThatHangsFarFromItsPlaceIsNamedWithinSeconds) {
  for (const std::size_t entry : {1U, 4U, 6U}) {
    SCOPED_TRACE(entry);
    MarkerMap seen = map_;
    const Marker& mapped = map_.markers[entry];
    // Between two others.
    seen.markers[entry] =
        ringMarker(mapped.id, direction(static_cast<int>(entry) + 2) + 0.45, mapped.center().z());
    const double distance = (seen.markers[entry].center() - mapped.center()).norm();
    log_ = {};
    watch(render(seen), 8.0);
    EXPECT_TRUE(wasRejected(mapped.id, "hangs elsewhere than the map says"));
    const std::vector<DisplacedMarker> named = log_.persistent();
    ASSERT_EQ(named.size(), 1U);
    EXPECT_EQ(named[0].map_entry, entry);
    EXPECT_NEAR(named[0].distance, distance, 0.1 * distance);
  }
}

TEST_F(OddMarkersTest, OneThatHangsBesideItsPlaceIsNamedWithinSeconds) {
  for (const double way : {0.1, 0.2, 0.3, 0.5, 0.7}) {
    SCOPED_TRACE(way);
    MarkerMap seen = map_;
    seen.markers[3].map_from_marker.translate(Eigen::Vector3d(way, 0.0, 0.0));
    log_ = {};
    watch(render(seen), 6.0);
    EXPECT_TRUE(wasRejected(map_.markers[3].id, ""));
    const std::vector<DisplacedMarker> named = log_.persistent();
    ASSERT_EQ(named.size(), 1U);
    EXPECT_EQ(named[0].map_entry, 3U);
    EXPECT_NEAR(named[0].distance, way, 0.1 * way);
  }
}

TEST_F(OddMarkersTest, NeighboursThatWereMovedAsOneDoNotPassForTheOthers) {
  // The first three that the robot sees may agree on a pose, but not on the wrong one.
  const Eigen::Isometry3d motion =
      Eigen::Translation3d(0.3, -0.2, 0.0) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ());
  for (std::size_t first = 0; first < map_.markers.size(); ++first) {
    SCOPED_TRACE(first);
    const cv::Mat image = render(afterMoving(first, motion));
    watch(image, 1.0);
    localizer_.forgetPose();
    const FrameResult result = search(image);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(acceptedOf(result, map_.markers[(first + k) % map_.markers.size()].id), 0);
    }
  }
}

TEST_F(OddMarkersTest, NeighboursThatWereMovedALittleDoNotTakeTheRobotAlong) {
  // One of the others may seem to be in its place from the pose that the moved ones give.
  constexpr double kWay = 0.1;
  constexpr double kOff = 0.02;
  constexpr std::size_t kStride = test::kSweepStride;
  int undecided = 0;
  int open = 0;
  for (std::size_t first = 0; first < map_.markers.size(); first += kStride) {
    for (const double azimuth : {0.0, 0.5 * kPi, kPi, 1.5 * kPi}) {
      SCOPED_TRACE(std::to_string(first) + " " + std::to_string(azimuth));
      const Eigen::Isometry3d motion(
          Eigen::Translation3d(kWay * std::cos(azimuth), kWay * std::sin(azimuth), 0.0));
      const cv::Mat image = render(afterMoving(first, motion));
      {
        SCOPED_TRACE("searching");
        localizer_.forgetPose();
        const FrameResult found = process(image);
        if (found.map_from_base) {
          expectSound(found);
        } else {
          EXPECT_NE(found.remark.find("explain what was read about equally well"),
                    std::string::npos);
          ++undecided;
        }
      }
      {
        SCOPED_TRACE("tracking");
        const Pose off{truth_.x + kOff * std::sin(azimuth), truth_.y - kOff * std::cos(azimuth),
                       truth_.yaw + 0.5 * kOff};
        localizer_.setPose(floorEstimate(off, Eigen::Vector3d(4e-4, 4e-4, 1e-4).asDiagonal()));
        for (int i = 0; i < 5; ++i) {
          const FrameResult result = process(image);
          EXPECT_EQ(result.mode, Mode::kTracking);
          if (result.is_open && result.map_from_base) {
            // While undecided, the covariance covers the error.
            EXPECT_LT(test::deviations(*result.map_from_base, truth_), 5.0);
            ++open;
          } else {
            expectSound(result);
          }
        }
      }
      {
        SCOPED_TRACE("started by hand");
        localizer_.setPose(Pose{truth_.x - 0.2, truth_.y + 0.1, truth_.yaw - 0.05});
        // If the given pose is no more exact than the markers' motion, neither is certain.
        for (int i = 0; i < 5; ++i) {
          const FrameResult result = process(image);
          if (!result.is_open) {
            expectSound(result);
          } else if (result.map_from_base) {
            EXPECT_LT(test::deviations(*result.map_from_base, truth_), 5.0);
          }
        }
      }
    }
  }
  EXPECT_LE(undecided, 7) << "of 28 searches";
  EXPECT_LE(open, 25) << "of 140 images";
}

TEST_F(OddMarkersTest, ASmallOneInItsPlaceIsHeardAgainstManyThatWereMovedAsOne) {
  // The last one is too small in the image to be read: it can only be recognized.
  for (const double size : {0.34, 0.38, 0.42, 0.46}) {
    SCOPED_TRACE(size);
    const MarkerMap seen{"map",
                         {test::hung(230, {6.507, 8.89, 1.19}, -kPi / 2, 0.37),
                          test::hung(513, {0.01, 7.385, 1.14}, 0.0, 0.32),
                          test::hung(142, {0.01, 8.269, 1.67}, 0.0, 0.44),
                          test::hung(528, {4.081, 8.89, 1.32}, -kPi / 2, 0.33),
                          test::hung(256, {0.01, 4.437, 1.06}, 0.0, size)}};
    map_ = seen;
    for (std::size_t entry = 0; entry < 4; ++entry) {
      map_.markers[entry].map_from_marker.pretranslate(Eigen::Vector3d(0.032, -0.158, 0.0));
    }
    truth_ = {4.391, 7.16, radians(164.48)};
    Localizer localizer(model_, map_, test::onLevelFloor());
    localizer.setPose(truth_);
    const cv::Mat image = render(seen);
    int poses = 0;
    for (int i = 0; i < 5; ++i) {
      const FrameResult result = localizer.process({kPeriod * i, image, mounting_, std::nullopt});
      if (!result.map_from_base) continue;
      ++poses;
      EXPECT_TRUE(test::positionError(result.map_from_base->pose, truth_) < 0.02 ||
                  test::deviations(*result.map_from_base, truth_) < 5.0)
          << i;
    }
    EXPECT_GT(poses, 0);
  }
}

TEST_F(OddMarkersTest, OnesThatWereMovedShowWhereTheOthersAre) {
  // Those in their places are too small in the image to be read.
  const MarkerMap seen{
      "map",
      {test::hung(1, {2.2, 0.6, 1.0}, kPi, 0.45), test::hung(2, {2.2, -0.6, 1.3}, kPi, 0.45),
       test::hung(3, {-4.8, 1.0, 1.2}, 0.0, 0.42), test::hung(4, {-4.8, -1.5, 1.6}, 0.0, 0.42),
       test::hung(5, {0.5, 4.8, 1.1}, -kPi / 2, 0.42)}};
  map_ = seen;
  // A partition was turned about its middle.
  const Eigen::Isometry3d turned = Eigen::Translation3d(2.2, 0.0, 0.0) *
                                   Eigen::AngleAxisd(0.25, Eigen::Vector3d::UnitZ()) *
                                   Eigen::Translation3d(-2.2, 0.0, 0.0);
  for (std::size_t entry = 0; entry < 2; ++entry) {
    map_.markers[entry].map_from_marker = turned * map_.markers[entry].map_from_marker;
  }
  Localizer localizer(model_, map_, test::onLevelFloor());
  truth_ = {0.0, 0.0, 0.3};
  localizer.setPose(truth_);
  for (int i = 0; i < 6; ++i) {
    SCOPED_TRACE(i);
    const FrameResult result =
        localizer.process({kPeriod * i, render(seen), mounting_, std::nullopt});
    ASSERT_TRUE(result.map_from_base) << result.remark;
    EXPECT_LT(test::positionError(result.map_from_base->pose, truth_), 1e-2);
    EXPECT_EQ(result.acceptedMarkers(), 3);
    // Without odometry, its motion is a surprise.
    truth_.x += 0.04;
    truth_.y += 0.03;
  }
}

TEST_F(OddMarkersTest, AllThatWereHungAnewAreNamed) {
  MarkerMap seen = map_;
  for (const std::size_t entry : {0U, 3U, 5U}) {
    seen.markers[entry].map_from_marker.translate(Eigen::Vector3d(0.9, 0.0, 0.0));
  }
  watch(render(seen), 12.0);
  const std::vector<DisplacedMarker> named = log_.persistent();
  ASSERT_EQ(named.size(), 3U);
  EXPECT_EQ(named[0].map_entry, 0U);
  EXPECT_EQ(named[1].map_entry, 3U);
  EXPECT_EQ(named[2].map_entry, 5U);
  for (const DisplacedMarker& each : named) EXPECT_NEAR(each.distance, 0.9, 0.1);
}

TEST_F(OddMarkersTest, ARejectedMarkerIsMeasuredOncePerSecondAtMost) {
  MarkerMap seen = map_;
  seen.markers[3].map_from_marker.translate(Eigen::Vector3d(0.15, 0.0, 0.0));
  const cv::Mat image = render(seen);
  localizer_.setPose(truth_);
  int measured = 0;
  constexpr int kSeconds = 8;
  for (int i = 0; i < 10 * kSeconds; ++i) {
    measured += static_cast<int>(process(image).displaced.size());
  }
  // From when the patrol first reads it, which takes up to two seconds.
  EXPECT_GE(measured, kSeconds - 3);
  EXPECT_LE(measured, kSeconds);
}

TEST_F(OddMarkersTest, OneThatIsPrintedMirroredIsNotTakenForItsEntry) {
  MarkerMap seen = map_;
  seen.markers[2].map_from_marker.linear().col(0) *= -1.0;
  const cv::Mat image = render(seen);
  EXPECT_EQ(acceptedOf(search(image), map_.markers[2].id), 0);
  watch(image, 2.0);
  EXPECT_EQ(acceptedOf(process(image), map_.markers[2].id), 0);
  EXPECT_TRUE(log_.persistent().empty());
}

TEST_F(OddMarkersTest, AReflectionInAWindowIsHarmless) {
  // A pane 2.4 m from the middle, between two markers, mirrors those opposite.
  const double direction = this->direction(2) + 0.45;
  const Eigen::Vector3d normal(std::cos(direction), std::sin(direction), 0.0);
  const Eigen::Matrix3d reflection =
      Eigen::Matrix3d::Identity() - 2.0 * normal * normal.transpose();
  MarkerMap seen = map_;
  for (const std::size_t entry : {5U, 6U}) {
    Marker reflected = map_.markers[entry];
    reflected.map_from_marker.linear() = reflection * reflected.map_from_marker.linear();
    reflected.map_from_marker.translation() =
        reflection * (reflected.center() - 2.4 * normal) + 2.4 * normal;
    seen.markers.push_back(reflected);
  }
  const cv::Mat image = render(seen);
  EXPECT_EQ(search(image).acceptedMarkers(), 7);
  watch(image, 6.0);
  EXPECT_TRUE(log_.persistent().empty());
}

TEST_F(OddMarkersTest, HalfAMarkerIsHarmless) {
  const MountedCamera camera(model_, mounting_);
  const cv::Mat whole = render(map_);
  for (const double covered : {0.3, 0.5, 0.7}) {
    SCOPED_TRACE(covered);
    // A board in front of the left part of the marker, as a person sees it.
    const Marker& marker = map_.markers[4];
    std::vector<cv::Point> outline;
    for (const auto& [x, y] : {std::pair(-0.7, -0.7), std::pair(covered - 0.5, -0.7),
                               std::pair(covered - 0.5, 0.7), std::pair(-0.7, 0.7)}) {
      const auto pixel = camera.pixelFromMap(
          truth_, marker.map_from_marker * (marker.size * Eigen::Vector3d(x, y, 0.0)));
      ASSERT_TRUE(pixel);
      outline.emplace_back(static_cast<int>(std::lround(pixel->x())),
                           static_cast<int>(std::lround(pixel->y())));
    }
    cv::Mat image = whole.clone();
    cv::fillConvexPoly(image, outline, 100);
    localizer_.forgetPose();
    EXPECT_GE(search(image).acceptedMarkers(), 6);
    watch(image, 1.0);
    EXPECT_TRUE(log_.persistent().empty());
  }
}

TEST_F(OddMarkersTest, ACopyOfAMarkerIsRejectedAndTheMarkerIsNot) {
  MarkerMap seen = map_;
  const int id = map_.markers[5].id;
  seen.markers.push_back(ringMarker(id, direction(1) + 0.4, 1.2));
  const cv::Mat image = render(seen);
  const FrameResult found = search(image);
  EXPECT_EQ(acceptedOf(found, id), 1);
  EXPECT_EQ(found.acceptedMarkers(), 7);
  watch(image, 6.0);
  EXPECT_TRUE(wasRejected(id, "hangs elsewhere than the map says"));
  EXPECT_EQ(acceptedOf(process(image), id), 1);
  EXPECT_TRUE(log_.persistent().empty()) << "it hangs in its place, too";
}

TEST_F(OddMarkersTest, OneThatIsNotInTheMapIsRejected) {
  MarkerMap seen = map_;
  constexpr int kUnknown = 200;
  seen.markers.push_back(ringMarker(kUnknown, direction(3) + 0.4, 1.3));
  const cv::Mat image = render(seen);
  EXPECT_EQ(search(image).acceptedMarkers(), 7);
  watch(image, 6.0);
  EXPECT_TRUE(wasRejected(kUnknown, "not in the map"));
  EXPECT_TRUE(log_.persistent().empty());
}

TEST_F(OddMarkersTest, OneThatIsBeingMappedIsSaidToBeMissingOnlyYet) {
  MarkerMap seen = map_;
  constexpr int kUnknown = 200;
  seen.markers.push_back(ringMarker(kUnknown, direction(3) + 0.4, 1.3));
  LocalizerConfig config = test::onLevelFloor();
  config.exploring_views = 2;
  Localizer localizer(model_, map_, config);
  const FrameResult found = localizer.process({0.0, render(seen), mounting_, std::nullopt});
  EXPECT_TRUE(
      std::any_of(found.detections.begin(), found.detections.end(), [](const MarkerDetection& d) {
        return d.id == kUnknown && d.reason == "not in the map yet";
      }));
}

}  // namespace
}  // namespace omnitag
