#include "ros/transform_input.h"

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <tf2_msgs/TFMessage.h>

namespace omnitag {
namespace {

class TransformInputTest : public testing::Test {
 protected:
  TransformInputTest()
      : publisher_(node_.advertise<tf2_msgs::TFMessage>("/tf", 10000)),
        input_(node_, {"map", "", "base_link"}) {
    spinner_.start();
    while (publisher_.getNumSubscribers() == 0) ros::WallDuration(0.01).sleep();
  }

  void send(const std::string& parent, const std::string& child, const ros::Time& stamp) {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    message.transforms[0].header.frame_id = parent;
    message.transforms[0].header.stamp = stamp;
    message.transforms[0].child_frame_id = child;
    message.transforms[0].transform.rotation.w = 1.0;
    publisher_.publish(message);
  }

  /// Serves until the transform sent last has come.
  void serveUntil(const std::string& parent, const std::string& child, const ros::Time& stamp) {
    for (int i = 0; i < 100 && !input_.buffer().canTransform(parent, child, stamp); ++i) {
      input_.serve(0.1);
    }
    ASSERT_TRUE(input_.buffer().canTransform(parent, child, stamp));
  }

  ros::AsyncSpinner spinner_{1};
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  TransformInput input_;
};

TEST_F(TransformInputTest, LosesNothingWhileAFrameTakesLong) {
  // Ten seconds on a robot with a hundred transforms a second.
  constexpr int kCount = 1000;
  const auto stamp = [](int i) { return ros::Time(100.0 + 0.01 * i); };
  for (int i = 0; i < kCount; ++i) send("odom", "base_link", stamp(i));
  serveUntil("odom", "base_link", stamp(kCount - 1));
  for (int i = 0; i < kCount; ++i) {
    EXPECT_TRUE(input_.buffer().canTransform("odom", "base_link", stamp(i))) << i;
  }
}

TEST_F(TransformInputTest, NoticesAnotherParentOfTheRobot) {
  const ros::Time stamp(100.0);
  send("map", "base_link", stamp);
  serveUntil("map", "base_link", stamp);
  EXPECT_FALSE(input_.parentConflict());
  send("odom", "base_link", stamp + ros::Duration(1.0));
  serveUntil("odom", "base_link", stamp + ros::Duration(1.0));
  EXPECT_TRUE(input_.parentConflict());
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "transform_input_test");
  return RUN_ALL_TESTS();
}
