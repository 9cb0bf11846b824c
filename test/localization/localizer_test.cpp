#include "omnitag/localization/localizer.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <future>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "../support/level_floor.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "omnitag/common/error.h"
#include "view/view_warper.h"

namespace omnitag {
namespace {

MarkerMap room() {
  MarkerMap map{"map", {}};
  for (int i = 0; i < 7; ++i) {
    const double direction = 2.0 * kPi * i / 7 + 0.15 * (i % 2);
    Marker marker;
    marker.family = "tag36h11";
    marker.id = 3 * i;
    marker.size = 0.8;
    marker.map_from_marker =
        Eigen::Translation3d(3.5 * std::cos(direction), 3.5 * std::sin(direction), 1.0 + 0.08 * i) *
        uprightOrientation(direction + kPi, 0.0);
    map.markers.push_back(marker);
  }
  return map;
}

Pose routeAt(int frame) { return {0.6 + 0.08 * frame, -0.5 + 0.05 * frame, 0.4 + 0.06 * frame}; }

using test::positionError;

class LocalizerTest : public testing::TestWithParam<Eigen::Isometry3d> {
 protected:
  Frame frameAt(int index) const {
    return {0.1 * index, renderPanorama(map_, {camera_, mounting_}, routeAt(index)), mounting_,
            std::nullopt};
  }

  Localizer localizer(const LocalizerConfig& config = test::onLevelFloor()) const {
    return {camera_, map_, config};
  }

  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = GetParam();
  MarkerMap map_ = room();

  cv::Mat renderPanorama(const MarkerMap& map, const MountedCamera& camera,
                         const Pose& pose) const {
    return test::renderPanorama(map, camera, pose);
  }
};

TEST_P(LocalizerTest, FollowsARoute) {
  Localizer localizer = this->localizer();
  Pose start = routeAt(0);
  start.x += 0.05;
  start.yaw -= 0.03;
  localizer.setPose(start);
  for (int i = 0; i < 6; ++i) {
    const FrameResult result = localizer.process(frameAt(i));
    ASSERT_TRUE(result.map_from_base) << i;
    EXPECT_EQ(result.mode, Mode::kTracking);
    EXPECT_GE(result.acceptedMarkers(), 5);
    EXPECT_LT(positionError(result.map_from_base->pose, routeAt(i)), 2e-3) << i;
    EXPECT_NEAR(result.map_from_base->pose.yaw, routeAt(i).yaw, 5e-4) << i;
    EXPECT_EQ(result.view_images.size(), result.views.size());
  }
}

TEST_P(LocalizerTest, BearingsAreThoseOfTheMarkersFromTheRobot) {
  Localizer localizer = this->localizer();
  localizer.setPose(routeAt(0));
  const FrameResult result = localizer.process(frameAt(0));
  const Pose truth = routeAt(0);
  const Eigen::Isometry3d map_from_camera = truth.toIsometry() * mounting_;
  // Lines of sight start on the mirror, some 0.22 m along the optical axis.
  const Eigen::Vector3d mirror = map_from_camera * Eigen::Vector3d(0.0, 0.0, 0.22);
  for (const MarkerDetection& detection : result.detections) {
    if (!detection.accepted) continue;
    const Eigen::Vector3d center = map_.markers[*detection.map_entry].center();
    const Eigen::Vector3d way = center - mirror;
    const double expected = std::atan2(way.y(), way.x()) - truth.yaw;
    EXPECT_NEAR(normalizeAngle(detection.bearing - expected), 0.0, 0.001);
    const Eigen::Vector3d in_camera = map_from_camera.linear().transpose() * way.normalized();
    EXPECT_LT((detection.sight - in_camera).norm(), 0.01);
    EXPECT_NEAR(detection.range, (center - map_from_camera.translation()).head<2>().norm(), 5e-3);
    EXPECT_LT(detection.residual, 0.3);
    EXPECT_EQ(detection.reason, "");
  }
}

TEST_P(LocalizerTest, ASearchThatPeopleWatchShowsEachMarkerInOneView) {
  Localizer localizer = this->localizer();
  Frame frame = frameAt(0);
  frame.wants_views = true;
  const FrameResult result = localizer.process(frame);
  ASSERT_EQ(result.mode, Mode::kFound);
  ASSERT_GE(result.acceptedMarkers(), 5);
  ASSERT_EQ(result.view_images.size(), result.views.size());
  constexpr double kWorkingDistance = 3.0;  // m
  const ViewWarper warper(camera_, kWorkingDistance);
  for (const MarkerDetection& detection : result.detections) {
    if (!detection.accepted) continue;
    const auto shows = [&](const View& view) {
      const auto position = warper.viewFromPanorama(view, detection.center);
      return position && cv::Rect({0, 0}, view.size)
                             .contains({static_cast<int>(std::lround(position->x())),
                                        static_cast<int>(std::lround(position->y()))});
    };
    EXPECT_EQ(std::count_if(result.views.begin(), result.views.end(), shows), 1) << detection.id;
  }
}

TEST_P(LocalizerTest, TheSameInputGivesTheSameResult) {
  const auto poses = [this] {
    Localizer localizer = this->localizer();
    localizer.setPose(routeAt(0));
    std::vector<Pose> poses;
    for (int i = 0; i < 2; ++i) poses.push_back(localizer.process(frameAt(i)).map_from_base->pose);
    return poses;
  };
  const std::vector<Pose> first = poses();
  const std::vector<Pose> second = poses();
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].x, second[i].x);
    EXPECT_EQ(first[i].y, second[i].y);
    EXPECT_EQ(first[i].yaw, second[i].yaw);
  }
}

TEST_P(LocalizerTest, MoreThreadsGiveTheSameResult) {
  // One frame is searched, at a glance or all around, the next one tracked.
  for (const bool glances : {true, false}) {
    const auto poses = [this, glances](int threads) {
      LocalizerConfig config = test::onLevelFloor();
      config.threads = threads;
      config.look_around.glance = glances;
      Localizer localizer = this->localizer(config);
      std::vector<Pose> poses;
      for (int i = 0; i < 2; ++i) {
        poses.push_back(localizer.process(frameAt(i)).map_from_base->pose);
      }
      return poses;
    };
    const std::vector<Pose> alone = poses(1);
    const std::vector<Pose> together = poses(3);
    for (std::size_t i = 0; i < alone.size(); ++i) {
      EXPECT_EQ(alone[i].x, together[i].x);
      EXPECT_EQ(alone[i].y, together[i].y);
      EXPECT_EQ(alone[i].yaw, together[i].yaw);
    }
  }
}

TEST_P(LocalizerTest, SeveralMayWorkAtOnce) {
  // Like two nodelets in one manager.
  constexpr int kFrames = 3;
  std::vector<Frame> frames;
  for (int i = 0; i < kFrames; ++i) frames.push_back(frameAt(i));
  const auto poses = [this, &frames] {
    Localizer localizer = this->localizer();
    std::vector<Pose> poses;
    for (const Frame& frame : frames) {
      const FrameResult result = localizer.process(frame);
      poses.push_back(result.map_from_base ? result.map_from_base->pose : Pose{});
    }
    return poses;
  };
  std::vector<std::future<std::vector<Pose>>> threads;
  for (int i = 0; i < 3; ++i) threads.push_back(std::async(std::launch::async, poses));
  const std::vector<Pose> alone = poses();
  for (auto& thread : threads) {
    const std::vector<Pose> together = thread.get();
    for (int i = 0; i < kFrames; ++i) {
      const auto index = static_cast<std::size_t>(i);
      EXPECT_LT(positionError(together[index], routeAt(i)), 2e-3);
      EXPECT_EQ(together[index].x, alone[index].x);
      EXPECT_EQ(together[index].y, alone[index].y);
      EXPECT_EQ(together[index].yaw, alone[index].yaw);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Mountings, LocalizerTest,
                         testing::Values(test::lookingDown(), test::lookingUp()),
                         [](const auto& test) { return test.index == 0 ? "Down" : "Up"; });

class LocalizerFaultTest : public testing::Test {
 protected:
  Frame frame(double stamp, const cv::Mat& image) const {
    return {stamp, image, test::lookingDown(), std::nullopt};
  }

  static void expectAt(const Pose& truth, const FrameResult& result) {
    ASSERT_TRUE(result.map_from_base) << result.remark;
    EXPECT_LT(positionError(result.map_from_base->pose, truth), 2e-3);
    EXPECT_NEAR(normalizeAngle(result.map_from_base->pose.yaw - truth.yaw), 0.0, 1e-3);
  }

  std::shared_ptr<const CameraModel> camera_ = test::sphericalCamera();
  MarkerMap map_ = room();
  Localizer localizer_{camera_, map_, test::onLevelFloor()};
  cv::Mat good_ = test::renderPanorama(map_, {camera_, test::lookingDown()}, routeAt(0));
  cv::Mat black_ = cv::Mat::zeros(500, 500, CV_8UC1);
};

TEST_F(LocalizerFaultTest, ABlackImageWithoutAPoseGivesNoneAndSaysWhy) {
  const FrameResult result = localizer_.process(frame(0.0, black_));
  EXPECT_EQ(result.mode, Mode::kSearching);
  EXPECT_FALSE(result.map_from_base);
  EXPECT_NE(result.remark, "");
}

TEST_F(LocalizerFaultTest, FindsItsPoseInTheFirstFrameAndFollowsOn) {
  const FrameResult first = localizer_.process(frame(0.0, good_));
  expectAt(routeAt(0), first);
  EXPECT_EQ(first.mode, Mode::kFound);
  EXPECT_EQ(first.remark, "");
  EXPECT_EQ(first.view_images.size(), first.views.size());
  const FrameResult second = localizer_.process(frame(0.1, good_));
  expectAt(routeAt(0), second);
  EXPECT_EQ(second.mode, Mode::kTracking);
}

TEST_F(LocalizerFaultTest, AGlanceIsEnoughWhereTwoMarkersAreAllThatShouldBeSeen) {
  MarkerMap two = map_;
  two.markers.resize(2);
  const MountedCamera camera(camera_, test::lookingDown());
  Localizer localizer(camera_, two, test::onLevelFloor());
  const FrameResult result =
      localizer.process(frame(0.0, test::renderPanorama(two, camera, routeAt(0))));
  expectAt(routeAt(0), result);
  EXPECT_EQ(result.mode, Mode::kFound);
  EXPECT_EQ(result.acceptedMarkers(), 2);
  // A look all around would take eight.
  EXPECT_LE(result.views.size(), 2U);

  // Missing markers are a reason to doubt the pose, and to look all around.
  const FrameResult doubted =
      localizer_.process(frame(0.0, test::renderPanorama(two, camera, routeAt(0))));
  expectAt(routeAt(0), doubted);
  EXPECT_EQ(doubted.acceptedMarkers(), 2);
  EXPECT_EQ(doubted.views.size(), 8U);
}

TEST_F(LocalizerFaultTest, ASearchUsesMarkersThatItsViewsDoNotShowWhole) {
  // So near that it is wider than the overlap of neighbouring views.
  MarkerMap map = map_;
  map.markers.push_back(test::wallMarker(30, {1.1, -1.0, 1.1}, radians(135.0)));
  map.markers.back().size = 0.8;
  const cv::Mat image = test::renderPanorama(map, {camera_, test::lookingDown()}, routeAt(0));
  Localizer localizer(camera_, map, test::onLevelFloor());
  const FrameResult result = localizer.process(frame(0.0, image));
  expectAt(routeAt(0), result);
  EXPECT_EQ(result.mode, Mode::kFound);
  const auto near = std::find_if(result.detections.begin(), result.detections.end(),
                                 [](const MarkerDetection& d) { return d.id == 30; });
  ASSERT_NE(near, result.detections.end());
  EXPECT_TRUE(near->accepted);
  EXPECT_EQ(near->map_entry, map.markers.size() - 1);
  // It is recognized from a rough pose, so its outline stays a little tilted.
  const double limit = 0.01 * meanEdge(near->corners);
  EXPECT_LT(near->residual, limit);
  const auto exact =
      test::exactReading(map.markers.back(), {camera_, test::lookingDown()}, routeAt(0));
  for (std::size_t k = 0; k < exact->corners.size(); ++k) {
    EXPECT_LT((near->corners[k] - exact->corners[k]).norm(), limit) << k;
  }
}

TEST_F(LocalizerFaultTest, AMarkerTooSmallToBeDecodedConfirmsWhatAnotherLeavesOpen) {
  const Pose truth = routeAt(0);
  const auto at = [&truth](int id, double direction, double range, double size) {
    Marker marker = test::wallMarker(
        id, {truth.x + range * std::cos(direction), truth.y + range * std::sin(direction), 1.1},
        direction + kPi);
    marker.size = size;
    return marker;
  };
  // Seen almost from the front: its corners do not tell on which side the robot is.
  MarkerMap one{"map", {at(3, 0.5, 3.6, 0.8)}};
  one.markers[0].map_from_marker.rotate(Eigen::AngleAxisd(0.15, Eigen::Vector3d::UnitY()));
  MarkerMap two = one;
  two.markers.push_back(at(17, 2.4, 2.4, 0.22));
  // A third one that the image does not show is a reason to doubt a glance.
  MarkerMap map = two;
  map.markers.push_back(at(40, -1.6, 3.0, 0.8));
  const MountedCamera camera(camera_, test::lookingDown());

  const FrameResult alone = Localizer(camera_, map, test::onLevelFloor())
                                .process(frame(0.0, test::renderPanorama(one, camera, truth)));
  EXPECT_FALSE(alone.map_from_base);
  EXPECT_NE(alone.remark, "");
  const FrameResult together = Localizer(camera_, map, test::onLevelFloor())
                                   .process(frame(0.0, test::renderPanorama(two, camera, truth)));
  ASSERT_TRUE(together.map_from_base) << together.remark;
  EXPECT_EQ(together.acceptedMarkers(), 2);
  EXPECT_LT(positionError(together.map_from_base->pose, truth), 0.02);
}

TEST_F(LocalizerFaultTest, ARobotThatWasCarriedAwayIsFoundInTheSameFrame) {
  localizer_.setPose(routeAt(0));
  ASSERT_EQ(localizer_.process(frame(0.0, good_)).mode, Mode::kTracking);
  const Pose elsewhere{-1.3, 0.9, 2.6};
  const cv::Mat image = test::renderPanorama(map_, {camera_, test::lookingDown()}, elsewhere);
  const FrameResult carried = localizer_.process(frame(0.1, image));
  expectAt(elsewhere, carried);
  EXPECT_EQ(carried.mode, Mode::kFound);
  EXPECT_NE(carried.remark, "");
  EXPECT_GE(carried.acceptedMarkers(), 2);
  const FrameResult next = localizer_.process(frame(0.2, image));
  expectAt(elsewhere, next);
  EXPECT_EQ(next.mode, Mode::kTracking);
  EXPECT_EQ(next.remark, "");
}

TEST_F(LocalizerFaultTest, AWrongPoseFromOutsideIsCorrected) {
  const Pose start = routeAt(0);
  localizer_.setPose(Pose{start.x + 1.5, start.y - 0.8, start.yaw + 1.0});
  expectAt(start, localizer_.process(frame(0.0, good_)));
}

TEST_F(LocalizerFaultTest, CarriesOnWithoutMarkersForAWhileAndThenSaysSo) {
  localizer_.setPose(routeAt(0));
  ASSERT_EQ(localizer_.process(frame(0.0, good_)).mode, Mode::kTracking);
  const FrameResult blind = localizer_.process(frame(0.1, black_));
  EXPECT_EQ(blind.mode, Mode::kDeadReckoning);
  ASSERT_TRUE(blind.map_from_base);
  const FrameResult again = localizer_.process(frame(0.2, good_));
  EXPECT_EQ(again.mode, Mode::kTracking);
  const FrameResult later = localizer_.process(frame(3.0, black_));
  EXPECT_EQ(later.mode, Mode::kSearching);
  EXPECT_FALSE(later.map_from_base);
}

TEST_F(LocalizerFaultTest, APoseFromOutsideOutlivesImagesWithoutMarkers) {
  // As RViz's "2D Pose Estimate" sends it by default, 0.4 m off.
  const Pose start = routeAt(0);
  const Pose pointed{start.x - 0.3, start.y + 0.25, start.yaw + 0.1};
  localizer_.setPose(floorEstimate(
      pointed, Eigen::Vector3d(0.25, 0.25, radians(15.0) * radians(15.0)).asDiagonal()));
  for (int i = 0; i < 20; ++i) {
    const FrameResult blind = localizer_.process(frame(0.45 * i, black_));
    EXPECT_EQ(blind.mode, Mode::kDeadReckoning) << i;
    ASSERT_TRUE(blind.map_from_base) << i;
    EXPECT_LT(positionError(blind.map_from_base->pose, pointed), 1e-9);
  }
  const FrameResult late = localizer_.process(frame(10.1, black_));
  EXPECT_EQ(late.mode, Mode::kSearching);
  EXPECT_FALSE(late.map_from_base);
}

TEST_F(LocalizerFaultTest, OdometryCarriesAPoseFromOutsideFromWhereItWasGiven) {
  const Pose map_from_odom{3.0, -1.0, 2.0};
  const Pose before{-1.0, 0.4, 1.2};
  localizer_.setPose(before, inverse(map_from_odom) * before);
  Frame later = frame(0.0, good_);
  later.odom_from_base = inverse(map_from_odom) * routeAt(0);
  const FrameResult result = localizer_.process(later);
  EXPECT_EQ(result.mode, Mode::kTracking);
  expectAt(routeAt(0), result);
}

TEST_F(LocalizerFaultTest, ForgetsItsPoseWhenTold) {
  localizer_.setPose(routeAt(0));
  ASSERT_TRUE(localizer_.process(frame(0.0, good_)).map_from_base);
  localizer_.forgetPose();
  const FrameResult blind = localizer_.process(frame(0.1, black_));
  EXPECT_EQ(blind.mode, Mode::kSearching);
  EXPECT_FALSE(blind.map_from_base);
  const FrameResult found = localizer_.process(frame(0.2, good_));
  EXPECT_EQ(found.mode, Mode::kFound);
  expectAt(routeAt(0), found);
}

TEST_F(LocalizerFaultTest, ReusedIdsAreToldApart) {
  for (std::size_t i = 0; i < map_.markers.size(); ++i) {
    map_.markers[i].id = static_cast<int>(i % 3);
  }
  const cv::Mat image = test::renderPanorama(map_, {camera_, test::lookingDown()}, routeAt(0));
  Localizer localizer(camera_, map_, test::onLevelFloor());
  for (int i = 0; i < 2; ++i) {
    const FrameResult result = localizer.process(frame(0.1 * i, image));
    expectAt(routeAt(0), result);
    EXPECT_EQ(result.mode, i == 0 ? Mode::kFound : Mode::kTracking);
    EXPECT_GE(result.acceptedMarkers(), 5);
  }
}

TEST_F(LocalizerFaultTest, AMirroredImageGivesNoMarkers) {
  cv::Mat mirrored;
  cv::flip(good_, mirrored, 1);
  localizer_.setPose(routeAt(0));
  EXPECT_EQ(localizer_.process(frame(0.0, mirrored)).acceptedMarkers(), 0);
}

TEST_F(LocalizerFaultTest, RefusesBadFramesAndKeepsItsState) {
  localizer_.setPose(routeAt(0));
  ASSERT_TRUE(localizer_.process(frame(1.0, good_)).map_from_base);
  const auto refusal = [this](const Frame& bad) -> std::string {
    try {
      localizer_.process(bad);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal(frame(1.1, cv::Mat::zeros(400, 500, CV_8UC1))).find("500 x 400"),
            std::string::npos);
  EXPECT_NE(refusal(frame(1.1, cv::Mat::zeros(500, 500, CV_8UC3))).find("CV_8UC3"),
            std::string::npos);
  EXPECT_NE(refusal(frame(1.1, cv::Mat())), "");
  EXPECT_NE(refusal(frame(1.0, good_)).find("later than"), std::string::npos);
  EXPECT_NE(refusal(frame(std::nan(""), good_)), "");
  EXPECT_EQ(localizer_.process(frame(1.1, good_)).mode, Mode::kTracking);
}

TEST_F(LocalizerFaultTest, AMarkerThatHangsElsewhereIsNamed) {
  MarkerMap wrong = map_;
  wrong.markers[2].map_from_marker.translation() += Eigen::Vector3d(0.25, 0.1, 0.0);
  Localizer localizer(camera_, wrong, test::onLevelFloor());
  localizer.setPose(routeAt(0));
  const FrameResult result = localizer.process(frame(0.0, good_));
  ASSERT_TRUE(result.map_from_base);
  EXPECT_LT(positionError(result.map_from_base->pose, routeAt(0)), 2e-3);
  for (const MarkerDetection& detection : result.detections) {
    if (detection.id != wrong.markers[2].id) continue;
    EXPECT_FALSE(detection.accepted);
    EXPECT_NE(detection.reason, "");
  }
}

TEST(LocalizerConstructionTest, RefusesAFamilyThatTheLibraryDoesNotHave) {
  MarkerMap map = room();
  map.markers[0].family = "tag99h99";
  EXPECT_THROW(Localizer(test::sphericalCamera(), map, test::onLevelFloor()), InputError);
}

}  // namespace
}  // namespace omnitag
