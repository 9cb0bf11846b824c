#pragma once

#include <ros/ros.h>

#include <mutex>
#include <optional>
#include <string>

#include "omnitag/localization/saved_pose.h"

namespace omnitag {

/// Saves the robot's pose now and then, and at the end, for the next start. Safe to use from
/// several threads; the file is written in that of ROS's timers.
class PoseKeeper {
 public:
  /// Nothing is done where `period` (s, wall time) is 0.
  PoseKeeper(const ros::NodeHandle& node, std::string name, std::string path, double period);
  ~PoseKeeper();
  PoseKeeper(const PoseKeeper&) = delete;
  PoseKeeper& operator=(const PoseKeeper&) = delete;

  /// What was saved in this map's frame; none, with a line in the log, where there is no such file
  /// or it is wrong.
  std::optional<SavedPose> lastPose(const std::string& map_frame) const;

  /// Of an image that told where the robot is.
  void keep(const SavedPose& pose);

 private:
  void save();

  ros::NodeHandle node_;
  std::string name_;
  std::string path_;
  double period_;
  std::mutex mutex_;
  std::optional<SavedPose> unsaved_;
  ros::WallTimer timer_;
};

}  // namespace omnitag
