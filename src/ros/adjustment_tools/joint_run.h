#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drive.h"
#include "omnitag/adjustment/camera_calibration.h"
#include "omnitag/adjustment/camera_template.h"
#include "omnitag/adjustment/map_builder.h"
#include "omnitag/adjustment/time_calibration.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// What of a drive is known beforehand, and what is wanted of it.
struct JointRequest {
  CameraTemplate guess;
  /// Whose markers are as soft as their deviations say; of no markers where nothing is known.
  MarkerMap seed;
  /// How unknown markers are placed at first, and what was measured between markers.
  MapBuilderConfig growth;
  CalibrationConfig calibration;
  /// Whether the times of the images' rows are estimated, by odometry.
  bool estimates_times = false;
};

/// What a drive tells.
struct JointResult {
  CalibrationResult camera;
  std::optional<TimeCalibration> time;
  /// The seed's markers in their order, then the others.
  BuiltMap map;

  /// The camera as it is written, `guess` being what it was looked for from.
  std::shared_ptr<const CameraModel> model(const CameraTemplate& guess) const;
};

/// Camera, mounting, map and times out of one drive. The bags are read three times: with the guess,
/// with the camera found, and by all pixels of the markers. Says on standard error what it does.
/// Throws InputError as calibrateCamera() and buildMap() do.
JointResult runJointly(const JointRequest& request, Drive* drive);

}  // namespace omnitag
