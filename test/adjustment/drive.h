#pragma once

#include <Eigen/Geometry>
#include <random>
#include <string>
#include <vector>

#include "../support/sample_markers.h"
#include "localization/frame_readings.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag::test {

/// Camera files: a sphere of 500 x 500 pixels, whose circle is 190 pixels, and a hyperbola.
inline std::string catadioptricFile(double fx, double cx, double cy, double apex_distance,
                                    const std::string& shape) {
  return "model: catadioptric\nimage: {width: 500, height: 500}\nuncertainty: none\nlens: {fx: " +
         std::to_string(fx) + ", fy: " + std::to_string(fx) + ", cx: " + std::to_string(cx) +
         ", cy: " + std::to_string(cy) +
         "}\nmirror: {apex_distance: " + std::to_string(apex_distance) + ", " + shape + "}\n";
}

constexpr const char* kSphere = "profile: spherical, radius_of_curvature: 0.04, rim_radius: 0.0375";

/// The mounting of a camera that looks down on its mirror from a height (m); tf's roll and pitch,
/// besides the half turn.
inline Eigen::Isometry3d mounting(double height, double roll, double pitch) {
  return Eigen::Translation3d(0.1, 0.02, height) *
         Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(kPi - roll, Eigen::Vector3d::UnitX());
}

/// The room of ten markers, large enough to be read well from everywhere in it.
inline MarkerMap roomMap() {
  MarkerMap map;
  map.markers = roomMarkers();
  for (Marker& marker : map.markers) marker.size = 1.2;
  return map;
}

/// Poses in a square about the room's middle, with all headings.
inline std::vector<Pose> posesInRoom(int count, double half_side, std::mt19937* generator) {
  std::uniform_real_distribution<double> place(-half_side, half_side);
  std::uniform_real_distribution<double> heading(-kPi, kPi);
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double x = place(*generator);
    const double y = place(*generator);
    poses.push_back({x, y, heading(*generator)});
  }
  return poses;
}

/// What a camera would read on the way, each corner with noise of `noise` pixels; the frames have
/// the mounting `believed_mounting`.
inline std::vector<FrameReadings> drive(const MarkerMap& map, const MountedCamera& truth,
                                        const std::vector<Pose>& poses, double noise,
                                        const Eigen::Isometry3d& believed_mounting,
                                        std::mt19937* generator) {
  std::vector<FrameReadings> frames;
  for (const Pose& pose : poses) {
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

/// The error that a call throws; empty if it throws none.
template <typename Call>
std::string refusalOf(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace omnitag::test
