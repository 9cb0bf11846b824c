#pragma once

#include <string>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Reads a calibration board (YAML, see doc/calibration.md): the target file of Kalibr's AprilGrid,
/// or a ChArUco board as OpenCV draws it. Gives its markers as a map of the frame `board`: x to the
/// right, y up and z out of the board for a person who looks at it, origin at its lower left. All
/// markers are exactly in their places. Throws InputError as loadMarkerMap() does.
MarkerMap loadBoard(const std::string& path);

/// The same from text; `origin` takes the place of the file name in errors.
MarkerMap parseBoard(const std::string& text, const std::string& origin);

}  // namespace omnitag
