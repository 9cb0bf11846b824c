#pragma once

#include <string>
#include <vector>

#include "omnitag/adjustment/bundle.h"
#include "omnitag/adjustment/corner_residual.h"

/// What says nothing about the camera: as told by the residuals of an adjustment.
namespace omnitag {

/// Pixels; infinity for a corner that should not be seen.
double lengthOf(const CornerResidual& corner);

/// 0 of none.
double medianOf(std::vector<double> sample);

/// Pixels: corners beyond are covered, misread or hang elsewhere.
double farLimit(const std::vector<CornerResidual>& residuals);

/// Takes out the frames whose pose started too far off to be found, and remarks on them.
void leaveOutFrames(Bundle* bundle, std::vector<std::string>* remarks);

/// Takes out what was read of the markers that hang elsewhere than the map says, and remarks on
/// them.
void leaveOutMarkers(Bundle* bundle, std::vector<std::string>* remarks);

}  // namespace omnitag
