#include <ros/ros.h>

#include "ros/localizer_starter.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "localizer");
  // ROS's log ends with the last handle, so the handles must outlive the error.
  const ros::NodeHandle node;
  const ros::NodeHandle private_node("~");
  try {
    const omnitag::LocalizerStarter starter(node, private_node);
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    return 1;
  }
  return 0;
}
