#pragma once

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "../support/sample_cameras.h"
#include "../support/sample_markers.h"
#include "localization/frame_readings.h"

namespace omnitag::test {

/// A robot that drives round the middle of the room of roomMarkers(), one image every 0.25 s.
inline std::vector<Pose> roundTrip(int count, double radius = 1.6) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * i / count;
    poses.push_back({radius * std::cos(angle), radius * std::sin(angle),
                     normalizeAngle(angle + 0.5 * kPi + 0.1 * std::sin(3.0 * i))});
  }
  return poses;
}

/// What the camera reads of the markers at each pose, with noise (pixels). Odometry drifts by 1 %.
inline std::vector<FrameReadings> record(const std::vector<Marker>& markers,
                                         const std::vector<Pose>& poses, double noise,
                                         bool has_odometry = false) {
  // The farthest that a decoder reads the markers.
  constexpr double kMaxRange = 6.0;
  std::mt19937 random(7);
  const auto camera = sphericalCamera();
  std::vector<FrameReadings> frames;
  Pose odom_from_base{5.0, 5.0, 1.0};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    FrameReadings frame;
    frame.stamp = 10.0 + 0.25 * static_cast<double>(i);
    frame.base_from_camera = lookingDown();
    const MountedCamera mounted(camera, frame.base_from_camera);
    if (i > 0) {
      Pose motion = inverse(poses[i - 1]) * poses[i];
      motion.x *= 1.01;
      motion.yaw *= 0.99;
      odom_from_base = odom_from_base * motion;
    }
    if (has_odometry) frame.odom_from_base = odom_from_base;
    for (const Marker& marker : markers) {
      const auto reading = exactReading(marker, mounted, poses[i]);
      const double range =
          (marker.center().head<2>() - Eigen::Vector2d(poses[i].x, poses[i].y)).norm();
      if (reading && range < kMaxRange)
        frame.readings.push_back(withNoise(*reading, noise, &random));
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace omnitag::test
