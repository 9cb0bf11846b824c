#pragma once

#include <string>
#include <vector>

#include "omnitag/localization/frame_readings.h"
#include "omnitag/localization/observation.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The mapped markers that were read in one image; each at most once.
struct CalibrationFrame {
  double stamp = 0.0;
  std::vector<MarkerObservation> observations;
};

/// What a calibration stands on.
struct CalibrationData {
  std::vector<CalibrationFrame> frames;
  /// What was left out and why, a line each.
  std::vector<std::string> remarks;
};

/// The readings of a recording that say without doubt which marker of the map they are, in frames
/// that have at least three: fewer do not tell the robot's pose while the camera is not known.
///
/// `prefers_large`: small markers, whose corners are less exact, count only where there are too few
/// large ones. Throws InputError, with what to do, where the readings cannot calibrate a camera:
/// too few frames, too few markers, ids that the map has twice.
CalibrationData selectObservations(const MarkerMap& map, const std::vector<FrameReadings>& frames,
                                   bool prefers_large = true);

}  // namespace omnitag
