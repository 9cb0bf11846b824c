#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adjustment/camera_calibration.h"
#include "adjustment/camera_template.h"
#include "adjustment/map_builder.h"
#include "adjustment/time_calibration.h"
#include "omnitag/marker/marker_map.h"
#include "ros/adjustment_tools/drive.h"

namespace omnitag {

/// What is known about a drive beforehand, and what to find out.
struct JointRequest {
  CameraTemplate guess;
  /// Its markers may move within their deviations; without markers if nothing is known.
  MarkerMap seed;
  /// How to place unknown markers at first, and what was measured between markers.
  MapBuilderConfig growth;
  CalibrationConfig calibration;
  /// Whether to estimate the times of the images' rows, by odometry.
  bool estimates_times = false;
};

/// The result of a drive.
struct JointResult {
  CalibrationResult camera;
  std::optional<TimeCalibration> time;
  /// The seed's markers in their order, followed by the others.
  BuiltMap map;

  /// The calibrated camera. `guess`: the camera that the search started from.
  std::shared_ptr<const CameraModel> model(const CameraTemplate& guess) const;
};

/// Estimates camera, mounting, map and times from one drive. Reads the bags three times: with the
/// guess, with the camera found, and by all pixels of the markers. Reports its steps on standard
/// error. Throws InputError as calibrateCamera() and buildMap() do.
JointResult runJointly(const JointRequest& request, Drive* drive);

}  // namespace omnitag
