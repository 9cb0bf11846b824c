#pragma once

#include <string>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Reads a marker map (YAML, the format is described in the README). Throws InputError with one
/// line that names the file, the line and the key where something is missing, unknown, out of its
/// range or contradicts itself, where a name stands twice, or where there is no marker at all.
MarkerMap loadMarkerMap(const std::string& path);

/// The same from text; `origin` stands for the file name in errors.
MarkerMap parseMarkerMap(const std::string& text, const std::string& origin);

}  // namespace omnitag
