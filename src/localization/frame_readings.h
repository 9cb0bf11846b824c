#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <vector>

#include "marker/marker_reader.h"
#include "omnitag/common/pose.h"

namespace omnitag {

/// The readings of one image of a recording, for estimates over all of its images.
struct FrameReadings {
  /// s.
  double stamp = 0.0;
  /// The camera's mounting, optical frame to robot.
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
  /// Odometry at the stamp, if the robot has any.
  std::optional<Pose> odom_from_base;
  /// Each marker once.
  std::vector<MarkerReading> readings;
  /// Which of several recordings it belongs to: odometry and time continue only within one.
  std::size_t recording = 0;
};

}  // namespace omnitag
