#include "ros/result_messages.h"

#include <gtest/gtest.h>

#include "ros/conversions.h"

namespace omnitag {
namespace {

constexpr double kTolerance = 0.25;

LocalizedImage localizedImage() {
  LocalizedImage localized;
  localized.input.header.frame_id = "camera";
  localized.input.header.stamp = ros::Time(100, 500);
  localized.result.map_from_base =
      floorEstimate({1.0, 2.0, 0.5}, Eigen::Matrix3d::Identity() * 0.01);
  return localized;
}

TEST(ResultMessages, MapToBaseWithoutOdometry) {
  const LocalizedImage localized = localizedImage();
  const ResultMessages messages =
      toMessages(localized, MarkerMap(), {"map", "", "base_link"}, kTolerance);
  ASSERT_TRUE(messages.transform && messages.pose && messages.pose_with_covariance);
  EXPECT_EQ(messages.transform->header.frame_id, "map");
  EXPECT_EQ(messages.transform->child_frame_id, "base_link");
  EXPECT_EQ(messages.transform->header.stamp, localized.input.header.stamp);
  EXPECT_EQ(messages.pose->header.frame_id, "map");
  EXPECT_EQ(messages.pose->header.stamp, localized.input.header.stamp);
  EXPECT_EQ(messages.pose_with_covariance->header, messages.pose->header);
  EXPECT_EQ(messages.detections.header, localized.input.header);
  EXPECT_EQ(messages.status.header, messages.pose->header);
  EXPECT_TRUE(
      fromMessage(messages.transform->transform).isApprox(fromMessage(messages.pose->pose), 1e-12));
}

TEST(ResultMessages, MapToOdomLeadsToTheSamePose) {
  LocalizedImage localized = localizedImage();
  // Odometry in six dimensions, as with an inertial unit.
  localized.input.odom_from_base =
      Eigen::Translation3d(-3.0, 0.5, 0.1) *
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(0.05, 0.1, 1.0).normalized());
  const ResultMessages messages =
      toMessages(localized, MarkerMap(), {"map", "odom", "base_link"}, kTolerance);
  ASSERT_TRUE(messages.transform);
  EXPECT_EQ(messages.transform->header.frame_id, "map");
  EXPECT_EQ(messages.transform->child_frame_id, "odom");
  EXPECT_EQ(messages.transform->header.stamp,
            localized.input.header.stamp + ros::Duration(kTolerance));
  // On a floor, the odometry's frame stays in the plane of the map; only odometry makes the base
  // lean in it.
  const Eigen::Isometry3d map_from_odom = fromMessage(messages.transform->transform);
  EXPECT_NEAR(map_from_odom.translation().z(), 0.0, 1e-12);
  EXPECT_NEAR(map_from_odom.linear()(2, 2), 1.0, 1e-12);
  const Pose map_from_base = Pose::fromIsometry(map_from_odom * *localized.input.odom_from_base);
  EXPECT_NEAR(map_from_base.x, 1.0, 1e-12);
  EXPECT_NEAR(map_from_base.y, 2.0, 1e-12);
  EXPECT_NEAR(map_from_base.yaw, 0.5, 1e-12);
}

TEST(ResultMessages, InSpaceMapToOdomLeadsToTheWholePose) {
  LocalizedImage localized = localizedImage();
  const Pose pose{1.0, 2.0, 0.5, 0.3, -0.2, 0.1};
  localized.result.map_from_base->pose = pose;
  localized.result.is_on_floor = false;
  localized.input.odom_from_base =
      Eigen::Translation3d(-3.0, 0.5, 0.1) *
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(0.05, 0.1, 1.0).normalized());
  const ResultMessages messages =
      toMessages(localized, MarkerMap(), {"map", "odom", "base_link"}, kTolerance);
  ASSERT_TRUE(messages.transform);
  const Eigen::Isometry3d map_from_base =
      fromMessage(messages.transform->transform) * *localized.input.odom_from_base;
  EXPECT_TRUE(map_from_base.isApprox(pose.toIsometry(), 1e-12));
  EXPECT_TRUE(fromMessage(messages.pose->pose).isApprox(pose.toIsometry(), 1e-12));
}

TEST(ResultMessages, NoTransformWithoutTheOdometryThatShouldBeThere) {
  const ResultMessages messages =
      toMessages(localizedImage(), MarkerMap(), {"map", "odom", "base_link"}, kTolerance);
  EXPECT_FALSE(messages.transform);
  EXPECT_TRUE(messages.pose);
}

TEST(ResultMessages, NothingButStatusWithoutAPose) {
  LocalizedImage localized = localizedImage();
  localized.result.map_from_base.reset();
  const ResultMessages messages =
      toMessages(localized, MarkerMap(), {"map", "", "base_link"}, kTolerance);
  EXPECT_FALSE(messages.transform);
  EXPECT_FALSE(messages.pose);
  EXPECT_FALSE(messages.pose_with_covariance);
  EXPECT_FALSE(messages.status.has_pose);
}

}  // namespace
}  // namespace omnitag
