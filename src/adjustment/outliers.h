#pragma once

#include <vector>

#include "omnitag/adjustment/calibration_data.h"
#include "omnitag/adjustment/camera_adjustment.h"
#include "omnitag/adjustment/camera_calibration.h"
#include "omnitag/marker/marker_map.h"

/// What says nothing about the camera: as told by the residuals of an adjustment.
namespace omnitag {

/// Pixels; infinity for a corner that should not be seen.
double lengthOf(const CornerResidual& corner);

/// 0 of none.
double medianOf(std::vector<double> sample);

/// Pixels: corners beyond are covered, misread or hang elsewhere.
double farLimit(const std::vector<CornerResidual>& residuals);

ResidualSummary summarize(const std::vector<CornerResidual>& residuals);

/// Takes out the frames whose pose started too far off to be found, and remarks on them.
void leaveOutFrames(const std::vector<CornerResidual>& residuals, CalibrationData* data,
                    CalibrationState* state);

/// Takes out the markers that hang elsewhere than the map says, and remarks on them.
void leaveOutMarkers(const std::vector<CornerResidual>& residuals, const MarkerMap& map,
                     CalibrationData* data);

}  // namespace omnitag
