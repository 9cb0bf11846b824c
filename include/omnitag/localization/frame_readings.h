#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <vector>

#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_reader.h"

namespace omnitag {

/// What was read in one image of a recording, for estimates over all of its images.
struct FrameReadings {
  /// s.
  double stamp = 0.0;
  /// The camera's mounting, optical frame to robot.
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
  /// Odometry at the stamp, where the robot has one.
  std::optional<Pose> odom_from_base;
  /// Each marker once.
  std::vector<MarkerReading> readings;
  /// Which of several recordings it is of: odometry and time go on within one alone.
  std::size_t recording = 0;
};

}  // namespace omnitag
