#pragma once

#include <Eigen/Geometry>
#include <random>
#include <vector>

#include "../support/sample_markers.h"
#include "omnitag/localization/frame_readings.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag::test {

/// The room of ten markers.
inline MarkerMap roomMap() {
  MarkerMap map;
  map.markers = roomMarkers();
  return map;
}

/// Poses all over the room's middle, with all headings.
inline std::vector<Pose2> posesInRoom(int count, std::mt19937* generator) {
  std::uniform_real_distribution<double> place(-2.5, 2.5);
  std::uniform_real_distribution<double> heading(-kPi, kPi);
  std::vector<Pose2> poses;
  for (int i = 0; i < count; ++i) {
    const double x = place(*generator);
    const double y = place(*generator);
    poses.push_back({x, y, heading(*generator)});
  }
  return poses;
}

/// What a camera would read on the way, each corner off by `noise` pixels; the frames say that the
/// camera is mounted at `believed_mounting`.
inline std::vector<FrameReadings> drive(const MarkerMap& map, const MountedCamera& truth,
                                        const std::vector<Pose2>& poses, double noise,
                                        const Eigen::Isometry3d& believed_mounting,
                                        std::mt19937* generator) {
  std::vector<FrameReadings> frames;
  for (const Pose2& pose : poses) {
    FrameReadings frame;
    frame.stamp = 0.1 * static_cast<double>(frames.size());
    frame.base_from_camera = believed_mounting;
    for (const Marker& marker : map.markers) {
      const auto reading = exactReading(marker, truth, pose);
      if (reading) frame.readings.push_back(withNoise(*reading, noise, generator));
    }
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace omnitag::test
