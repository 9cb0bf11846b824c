#pragma once

#include <string>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// m and rad: deviations of markers whose map states none, as after a careful survey with a tape.
constexpr double kSurveyedDeviation = 0.005;
constexpr double kSurveyedOrientationDeviation = 0.0175;

/// Reads a marker map (YAML, the format is described in the README). Throws InputError with one
/// line that names the file, the line and the key if something is missing, unknown, out of its
/// range or contradictory, if a name occurs twice, if a pattern file cannot be used, or if there is
/// no marker.
MarkerMap loadMarkerMap(const std::string& path);

/// The same from text; `origin` takes the place of the file name in errors, and for the paths of
/// patterns, which are relative to it.
MarkerMap parseMarkerMap(const std::string& text, const std::string& origin);

}  // namespace omnitag
