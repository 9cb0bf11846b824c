#pragma once

#include "adjustment/map_builder.h"
#include "adjustment/recording.h"

namespace omnitag {

/// The conditions for building a map from a recording. Each check throws DegenerateRecording with
/// what is missing and what to do.

/// Images with markers, more than one marker, and no id read at more places in one image than the
/// seed has entries for it.
void checkReadings(const Recording& recording);

/// Poses for enough images, places of the robot that are far enough apart, and markers around it.
void checkPoses(const Recording& recording, const MapBuilderConfig& config);

}  // namespace omnitag
