#include "ros/frame_assembler.h"

#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>

#include <boost/make_shared.hpp>

namespace omnitag {
namespace {

geometry_msgs::TransformStamped transform(const std::string& parent, const std::string& child,
                                          const ros::Time& stamp, double x, double yaw) {
  geometry_msgs::TransformStamped message;
  message.header.frame_id = parent;
  message.header.stamp = stamp;
  message.child_frame_id = child;
  message.transform.translation.x = x;
  message.transform.rotation.z = std::sin(yaw / 2.0);
  message.transform.rotation.w = std::cos(yaw / 2.0);
  return message;
}

cv_bridge::CvImagePtr image(int width, int height) {
  auto made = boost::make_shared<cv_bridge::CvImage>();
  made->header.frame_id = "camera";
  made->header.stamp = ros::Time(10.5);
  made->image = cv::Mat::zeros(height, width, CV_8UC1);
  return made;
}

class FrameAssemblerTest : public testing::Test {
 protected:
  FrameAssemblerTest() : transforms_(ros::Duration(100.0)) {
    transforms_.setTransform(transform("base_link", "camera", ros::Time(), 0.1, 0.2), "test", true);
  }

  std::string refusal(const cv_bridge::CvImageConstPtr& image) {
    try {
      FrameAssembler("camera.yaml", {40, 30}, frames_).assemble(image, transforms_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  FrameNames frames_;
  tf2::BufferCore transforms_;
};

TEST_F(FrameAssemblerTest, TakesTheMountingFromTf) {
  const FrameAssembler assembler("camera.yaml", {40, 30}, frames_);
  const auto input = image(40, 30);
  EXPECT_TRUE(assembler.hasTransforms(input->header, transforms_));
  const AssembledFrame assembled = assembler.assemble(input, transforms_);
  EXPECT_DOUBLE_EQ(assembled.frame.stamp, 10.5);
  EXPECT_EQ(assembled.frame.image.data, input->image.data);
  EXPECT_DOUBLE_EQ(assembled.frame.base_from_camera.translation().x(), 0.1);
  EXPECT_NEAR(assembled.frame.base_from_camera.linear()(1, 0), std::sin(0.2), 1e-12);
  EXPECT_FALSE(assembled.frame.odom_from_base);
  EXPECT_EQ(assembled.odometry_problem, "");
}

TEST_F(FrameAssemblerTest, InterpolatesOdometryAtTheStamp) {
  frames_.odom = "odom";
  transforms_.setTransform(transform("odom", "base_link", ros::Time(10.0), 1.0, 0.4), "test");
  transforms_.setTransform(transform("odom", "base_link", ros::Time(11.0), 2.0, 0.8), "test");
  const AssembledFrame assembled =
      FrameAssembler("camera.yaml", {40, 30}, frames_).assemble(image(40, 30), transforms_);
  ASSERT_TRUE(assembled.frame.odom_from_base);
  EXPECT_NEAR(assembled.frame.odom_from_base->x, 1.5, 1e-9);
  EXPECT_NEAR(assembled.frame.odom_from_base->yaw, 0.6, 1e-9);
}

TEST_F(FrameAssemblerTest, TakesTheVelocityWhileTheRowsAreExposed) {
  frames_.odom = "odom";
  // At rest until the stamp, then at 1 m/s and 0.4 rad/s.
  transforms_.setTransform(transform("odom", "base_link", ros::Time(10.0), 1.0, 0.4), "test");
  transforms_.setTransform(transform("odom", "base_link", ros::Time(10.5), 1.0, 0.4), "test");
  ShutterConfig shutter;
  shutter.row_readout_time = 1e-3;
  const FrameAssembler assembler("camera.yaml", {40, 30}, frames_, shutter);
  const auto input = image(40, 30);
  // Odometry does not reach the last row yet: until more is known, the robot stays at rest.
  EXPECT_FALSE(assembler.hasTransforms(input->header, transforms_));
  const AssembledFrame early = assembler.assemble(input, transforms_);
  ASSERT_TRUE(early.frame.velocity);
  EXPECT_LT(early.frame.velocity->norm(), 1e-9);

  transforms_.setTransform(transform("odom", "base_link", ros::Time(11.5), 2.0, 0.8), "test");
  EXPECT_TRUE(assembler.hasTransforms(input->header, transforms_));
  const AssembledFrame assembled = assembler.assemble(input, transforms_);
  ASSERT_TRUE(assembled.frame.velocity);
  const PoseVector& velocity = *assembled.frame.velocity;
  EXPECT_NEAR(velocity.head<2>().norm(), 1.0, 1e-3);
  EXPECT_NEAR(std::atan2(velocity[1], velocity[0]), -0.4, 0.01);
  EXPECT_NEAR(velocity[2], 0.4, 1e-6);
}

TEST_F(FrameAssemblerTest, GoesOnWithoutOdometryAndSaysSo) {
  frames_.odom = "odom";
  const FrameAssembler assembler("camera.yaml", {40, 30}, frames_);
  const auto input = image(40, 30);
  EXPECT_FALSE(assembler.hasTransforms(input->header, transforms_));
  const AssembledFrame assembled = assembler.assemble(input, transforms_);
  EXPECT_FALSE(assembled.frame.odom_from_base);
  EXPECT_FALSE(assembled.odom_from_base);
  EXPECT_NE(assembled.odometry_problem.find("from 'base_link' to 'odom'"), std::string::npos);
}

TEST_F(FrameAssemblerTest, NamesTheFramesOfAMissingMounting) {
  const auto input = image(40, 30);
  input->header.frame_id = "other_camera";
  EXPECT_THROW(FrameAssembler("camera.yaml", {40, 30}, frames_).assemble(input, transforms_),
               TransformError);
  EXPECT_NE(refusal(input).find("from 'other_camera' to 'base_link'"), std::string::npos);
}

TEST_F(FrameAssemblerTest, RefusesImagesThatAreNotOfThisCamera) {
  EXPECT_EQ(refusal(image(30, 40)),
            "the image has 30 x 40 pixels, expected 40 x 30 pixels as camera.yaml says");
  auto unnamed = image(40, 30);
  unnamed->header.frame_id = "";
  EXPECT_NE(refusal(unnamed).find("header.frame_id is empty"), std::string::npos);
  auto unstamped = image(40, 30);
  unstamped->header.stamp = ros::Time();
  EXPECT_NE(refusal(unstamped).find("header.stamp is zero"), std::string::npos);
}

TEST_F(FrameAssemblerTest, ChecksAnImageWithoutTransforms) {
  transforms_.clear();
  const FrameAssembler assembler("camera.yaml", {40, 30}, frames_);
  const auto input = image(40, 30);
  EXPECT_NO_THROW(assembler.check(*input));
  EXPECT_THROW(assembler.check(*image(30, 40)), InputError);
  input->header.frame_id = "";
  EXPECT_THROW(assembler.check(*input), InputError);
}

}  // namespace
}  // namespace omnitag
