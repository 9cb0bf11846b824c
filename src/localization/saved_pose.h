#pragma once

#include <string>

#include "omnitag/common/pose.h"

namespace omnitag {

/// A pose that is kept from one run to the next.
struct SavedPose {
  std::string map_frame;
  /// s, of the image that gave it; for people.
  double stamp = 0.0;
  PoseEstimate map_from_base;
};

/// The text of a file with the pose (YAML).
std::string textOf(const SavedPose& saved);

/// Reads such a file. Throws InputError with one line that names the file, the line and the key if
/// something is missing, unknown or not finite, or if the covariance is invalid.
SavedPose parseSavedPose(const std::string& text, const std::string& origin);
SavedPose loadSavedPose(const std::string& path);

/// The pose of a robot that nobody watched in the meantime: the saved covariance plus that of a
/// pose that a person gives (standard deviations in m and rad).
PoseEstimate afterAPause(const PoseEstimate& saved, double position_deviation,
                         double heading_deviation);

}  // namespace omnitag
