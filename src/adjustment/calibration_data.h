#pragma once

#include <string>
#include <vector>

#include "localization/frame_readings.h"
#include "localization/observation.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The mapped markers that were read in one image; each at most once.
struct CalibrationFrame {
  double stamp = 0.0;
  std::vector<MarkerObservation> observations;
};

/// The observations that a calibration uses.
struct CalibrationData {
  std::vector<CalibrationFrame> frames;
  /// What was left out and why, a line each.
  std::vector<std::string> remarks;
};

/// The readings of a recording that clearly belong to one marker of the map, in frames with at
/// least three of them: fewer do not determine the robot's pose while the camera is unknown.
///
/// `prefers_large`: use small markers, whose corners are less exact, only if there are too few
/// large ones. Throws InputError, with what to do, if the readings cannot calibrate a camera: too
/// few frames, too few markers, ids that occur twice in the map.
CalibrationData selectObservations(const MarkerMap& map, const std::vector<FrameReadings>& frames,
                                   bool prefers_large = true);

}  // namespace omnitag
