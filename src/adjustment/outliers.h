#pragma once

#include <string>
#include <vector>

#include "adjustment/bundle.h"
#include "adjustment/corner_residual.h"

/// Observations that are useless for the camera, judged by the residuals of an adjustment.
namespace omnitag {

/// Length of a residual in pixels; infinity for a corner that should not be seen.
double lengthOf(const CornerResidual& corner);

/// The median; 0 for an empty sample.
double medianOf(std::vector<double> sample);

/// Residual in pixels beyond which corners are assumed to be covered, misread or elsewhere.
double farLimit(const std::vector<CornerResidual>& residuals);

/// Removes frames whose pose started too far off to converge, and remarks on them.
void leaveOutFrames(Bundle* bundle, std::vector<std::string>* remarks);

/// Removes observations of markers that hang elsewhere than the map says, and remarks on them.
void leaveOutMarkers(Bundle* bundle, std::vector<std::string>* remarks);

}  // namespace omnitag
