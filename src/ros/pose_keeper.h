#pragma once

#include <ros/ros.h>

#include <mutex>
#include <optional>
#include <string>

#include "localization/saved_pose.h"

namespace omnitag {

/// Saves the robot's pose for the next start, periodically and at the end. Safe to use from several
/// threads; the file is written by ROS's timers and by the destructor.
class PoseKeeper {
 public:
  /// Does nothing if `period` (s, wall time) is 0.
  PoseKeeper(const ros::NodeHandle& node, std::string name, std::string path, double period);
  ~PoseKeeper();
  PoseKeeper(const PoseKeeper&) = delete;
  PoseKeeper& operator=(const PoseKeeper&) = delete;

  /// The saved pose, if it is in this map's frame. None, with a line in the log, if there is no
  /// such file or it is wrong.
  std::optional<SavedPose> lastPose(const std::string& map_frame) const;

  /// The pose of an image whose markers showed where the robot is.
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
