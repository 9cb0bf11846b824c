#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "../support/level_floor.h"
#include "../support/panorama_renderer.h"
#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "omnitag/localization/localizer.h"

namespace omnitag {
namespace {

constexpr double kPeriod = 0.1;  // s between frames

/// A robot that is picked up and put down elsewhere without its odometry noticing.
class CarriedRobotTest : public testing::TestWithParam<bool> {
 protected:
  /// Keeps the robot at its start for long enough to be sure of its pose and velocity.
  void standAtStart() {
    localizer_.setPose(start_);
    for (int i = 0; i < 5; ++i) ASSERT_EQ(process(image_at_start_).mode, Mode::kTracking);
  }

  cv::Mat render(const MarkerMap& seen, const Pose& pose) const {
    return test::renderPanorama(seen, {model_, mounting_}, pose);
  }

  FrameResult process(const cv::Mat& image) {
    Frame frame{kPeriod * frames_++, image, mounting_, std::nullopt};
    if (has_odometry_) frame.odom_from_base = Pose{3.0, 1.0, -0.5};
    return localizer_.process(frame);
  }

  /// Expects no pose but a reason, or a right pose.
  static void expectNoWrongPose(const FrameResult& result, const Pose& truth, double tolerance) {
    if (!result.map_from_base) {
      EXPECT_NE(result.remark, "");
      return;
    }
    EXPECT_LT(test::positionError(result.map_from_base->pose, truth), tolerance);
    EXPECT_NEAR(normalizeAngle(result.map_from_base->pose.yaw - truth.yaw), 0.0, tolerance);
  }

  const bool has_odometry_ = GetParam();
  std::shared_ptr<const CameraModel> model_ = test::sphericalCamera();
  Eigen::Isometry3d mounting_ = test::lookingDown();
  Pose start_{0.3, -0.2, 0.5};
  MarkerMap map_{"map", test::roomMarkers()};
  Localizer localizer_{model_, map_, test::onLevelFloor()};
  cv::Mat image_at_start_ = render(map_, start_);
  int frames_ = 0;
};

TEST_P(CarriedRobotTest, IsFoundAtOnceHoweverFarItWasCarried) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> turn(-kPi, kPi);
  for (const double distance : {0.05, 0.2, 0.4, 0.8, 2.0}) {
    for (const double yaw : {0.0, 0.02, 0.2}) {
      SCOPED_TRACE(testing::Message() << distance << " m, " << yaw << " rad");
      const double direction = turn(random);
      const Pose there{start_.x + distance * std::cos(direction),
                       start_.y + distance * std::sin(direction), start_.yaw + yaw};
      const cv::Mat image = render(map_, there);
      standAtStart();
      for (int i = 0; i < 2; ++i) {
        const FrameResult result = process(image);
        expectNoWrongPose(result, there, 5e-3);
        EXPECT_TRUE(result.map_from_base) << result.remark;
      }
    }
  }
}

TEST_P(CarriedRobotTest, HasNoWrongPoseWhereASingleMarkerIsInSight) {
  int found = 0;
  for (int id = 1; id < 10; id += 2) {
    SCOPED_TRACE(id);
    // In front of the marker, to one side.
    const Marker& marker = map_.markers[static_cast<std::size_t>(id)];
    const double azimuth =
        std::atan2(marker.normal().y(), marker.normal().x()) + radians(id % 4 == 1 ? 42.0 : -42.0);
    const Pose there{marker.center().x() + 2.2 * std::cos(azimuth),
                     marker.center().y() + 2.2 * std::sin(azimuth), 0.3 * id};
    const cv::Mat image = render({"map", {marker}}, there);
    standAtStart();
    FrameResult result;
    for (double time = 0.0; time < 1.5; time += kPeriod) {
      result = process(image);
      expectNoWrongPose(result, there, 0.03);
    }
    if (result.map_from_base) ++found;
  }
  EXPECT_GE(found, 4);
}

INSTANTIATE_TEST_SUITE_P(Odometry, CarriedRobotTest, testing::Bool(),
                         [](const auto& test) { return test.param ? "With" : "Without"; });

}  // namespace
}  // namespace omnitag
