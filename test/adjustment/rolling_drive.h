#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "../support/sample_markers.h"
#include "adjustment/odometry_at.h"
#include "camera/mounted_camera.h"
#include "camera/shutter.h"
#include "localization/frame_readings.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag::test {

/// The robot in the map as a function of time (s).
using Route = std::function<Pose(double time)>;

/// Up to 1.3 m/s and 1.6 rad/s, to and fro, left and right.
inline Pose livelyRoute(double time) {
  return {1.8 * std::sin(0.5 * time), 1.5 * std::sin(0.7 * time + 0.4),
          1.2 * std::sin(1.1 * time) + 0.3 * time};
}

/// A circle at a constant velocity.
inline Pose steadyRoute(double time) {
  return {1.5 * std::cos(0.6 * time), 1.5 * std::sin(0.6 * time), 0.6 * time};
}

inline Pose standing(double /*time*/) { return {0.3, -0.2, 0.4}; }

/// What a camera reads of a marker on this route: each point when the row that sees it is exposed.
inline std::optional<MarkerReading> rollingReading(const Marker& marker,
                                                   const MountedCamera& camera, const Route& route,
                                                   double stamp, const ShutterConfig& shutter) {
  std::optional<MarkerReading> reading = exactReading(marker, camera, route(stamp));
  if (!reading) return std::nullopt;
  const auto see = [&](const Eigen::Vector3d& point, Eigen::Vector2d* pixel) {
    for (int round = 0; round < 12; ++round) {
      const Pose then = route(stamp + shutter.timeOf(pixel->y()));
      const auto seen = camera.pixelFromMap(then, point);
      if (!seen) return false;
      *pixel = *seen;
    }
    return true;
  };
  const auto corners = marker.corners();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (!see(corners[k], &reading->corners[k])) return std::nullopt;
  }
  if (!see(marker.center(), &reading->center)) return std::nullopt;
  return reading;
}

/// Images at 5 Hz, stamped from 100 s on, each corner with noise of `noise` pixels.
inline std::vector<FrameReadings> rollingDrive(const MarkerMap& map, const MountedCamera& camera,
                                               const Route& route, const ShutterConfig& shutter,
                                               int count, double noise, std::mt19937* generator) {
  std::vector<FrameReadings> frames;
  for (int i = 0; i < count; ++i) {
    FrameReadings frame;
    frame.stamp = 100.0 + 0.2 * i;
    frame.base_from_camera = camera.baseFromCamera();
    for (const Marker& marker : map.markers) {
      const auto reading = rollingReading(marker, camera, route, frame.stamp, shutter);
      if (reading) frame.readings.push_back(withNoise(*reading, noise, generator));
    }
    frames.push_back(frame);
  }
  return frames;
}

/// Odometry at 50 Hz, from `begin` to `end` (s), interpolated by straight lines. Its errors along,
/// across and in turning are random, of this share (deviation) of the way and of the turn; they
/// change every fifth of a second.
class RolledOdometry {
 public:
  RolledOdometry(const Route& route, double begin, double end, double error,
                 std::mt19937* generator)
      : begin_(begin) {
    std::normal_distribution<double> normal;
    std::array<double, 3> draws{};
    Pose odom_from_base{2.0, -1.0, 0.7};
    for (int i = 0; begin + kPeriod * i <= end; ++i) {
      poses_.push_back(odom_from_base);
      if (i % 10 == 0) {
        for (double& draw : draws) draw = error * normal(*generator);
      }
      const double time = begin + kPeriod * i;
      Pose motion = inverse(route(time)) * route(time + kPeriod);
      const double way = std::hypot(motion.x, motion.y);
      motion.x += draws[0] * way;
      motion.y += draws[1] * way;
      motion.yaw += draws[2] * motion.yaw;
      odom_from_base = odom_from_base * motion;
    }
  }

  std::optional<Pose> operator()(double time) const {
    const double place = (time - begin_) / kPeriod;
    if (place < 0.0 || place >= static_cast<double>(poses_.size() - 1)) return std::nullopt;
    const auto i = static_cast<std::size_t>(place);
    const double share = place - static_cast<double>(i);
    const Pose motion = inverse(poses_[i]) * poses_[i + 1];
    return poses_[i] * Pose{share * motion.x, share * motion.y, share * motion.yaw};
  }

 private:
  static constexpr double kPeriod = 0.02;
  double begin_;
  std::vector<Pose> poses_;
};

}  // namespace omnitag::test
