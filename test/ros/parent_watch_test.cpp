#include "ros/parent_watch.h"

#include <gtest/gtest.h>

namespace omnitag {
namespace {

geometry_msgs::TransformStamped edge(const std::string& parent, const std::string& child) {
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  return transform;
}

const FrameNames kWithoutOdometry{"map", "", "base_link"};
const FrameNames kWithOdometry{"map", "odom", "base_link"};

TEST(ParentWatchTest, NamesTheOtherParentAndWhatToSet) {
  ParentWatch parents(kWithoutOdometry);
  EXPECT_FALSE(parents.conflict(0.0));
  parents.see(edge("/odom", "/base_link"), false, 1.0);
  ASSERT_TRUE(parents.conflict(1.0));
  EXPECT_EQ(*parents.conflict(1.0),
            "tf has 'odom' as the parent of 'base_link', and a frame has only one: 'map' -> "
            "'base_link' is not sent; set odom_frame to the robot's odometry frame, probably "
            "'odom', or base_frame to the robot's root frame");
}

TEST(ParentWatchTest, AStaticParentMayBeTheBaseItself) {
  ParentWatch parents(kWithoutOdometry);
  parents.see(edge("base_footprint", "base_link"), true, 1.0);
  parents.see(edge("odom", "base_link"), false, 2.0);
  ASSERT_TRUE(parents.conflict(1e6));
  EXPECT_NE(parents.conflict(1e6)->find("root frame, probably 'base_footprint'"),
            std::string::npos);
}

TEST(ParentWatchTest, WhatIsSentItselfIsNoConflict) {
  ParentWatch parents(kWithoutOdometry);
  parents.see(edge("map", "base_link"), false, 1.0);
  parents.see(edge("/map", "base_link"), false, 1.0);
  parents.see(edge("base_link", "camera"), true, 1.0);
  parents.see(edge("map", "odom"), false, 1.0);
  EXPECT_FALSE(parents.conflict(1.0));
}

TEST(ParentWatchTest, WithOdometryTheOdometryFrameCounts) {
  ParentWatch parents(kWithOdometry);
  parents.see(edge("odom", "base_link"), false, 1.0);
  parents.see(edge("map", "odom"), false, 1.0);
  EXPECT_FALSE(parents.conflict(1.0));
  parents.see(edge("world", "odom"), false, 1.0);
  ASSERT_TRUE(parents.conflict(1.0));
  EXPECT_NE(parents.conflict(1.0)->find("tf has 'world' as the parent of 'odom'"),
            std::string::npos);
}

TEST(ParentWatchTest, NamesAreComparedAsTfDoes) {
  ParentWatch parents({"/map", "", "base_link"});
  parents.see(edge("map", "base_link"), false, 1.0);
  parents.see(edge("/map", "/base_link"), false, 1.0);
  EXPECT_FALSE(parents.conflict(1.0));
}

TEST(ParentWatchTest, AStaticTransformFromTheMapIsSomebodyElses) {
  ParentWatch parents(kWithOdometry);
  parents.see(edge("map", "odom"), true, 1.0);
  ASSERT_TRUE(parents.conflict(1.0));
  EXPECT_NE(parents.conflict(1.0)->find("nothing else may be the parent of odom_frame"),
            std::string::npos);
}

TEST(ParentWatchTest, WhatIsNoTransformHasNoParent) {
  ParentWatch parents(kWithoutOdometry);
  parents.see(edge("", "base_link"), false, 1.0);
  parents.see(edge("base_link", "base_link"), false, 1.0);
  EXPECT_FALSE(parents.conflict(1.0));
}

TEST(ParentWatchTest, AParentThatIsNoLongerSentIsForgotten) {
  ParentWatch parents(kWithoutOdometry);
  parents.see(edge("odom", "base_link"), false, 1.0);
  EXPECT_TRUE(parents.conflict(10.9));
  EXPECT_FALSE(parents.conflict(11.1));
}

}  // namespace
}  // namespace omnitag
