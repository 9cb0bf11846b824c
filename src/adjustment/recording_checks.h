#pragma once

#include "omnitag/adjustment/map_builder.h"
#include "recording.h"

namespace omnitag {

/// What a recording must have for a map to be built from it. Each throws DegenerateRecording with
/// what is missing and what to do.

/// Images, markers in them, no id twice in an image that is not twice in the seed, and more than
/// one marker.
void checkReadings(const Recording& recording);

/// Poses for enough images, with the robot in places that are far enough apart, and markers around
/// it.
void checkPoses(const Recording& recording, const MapBuilderConfig& config);

}  // namespace omnitag
