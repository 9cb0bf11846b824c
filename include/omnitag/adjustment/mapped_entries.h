#pragma once

#include <string>
#include <vector>

#include "omnitag/adjustment/marker_mapper.h"
#include "omnitag/adjustment/marker_projection.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_map_writer.h"

namespace omnitag {

/// An estimated marker as an entry of a map file: its deviation is the largest of its position's, a
/// remark says for people where it faces and how well it is known.
MapEntry mappedEntry(const Marker& marker, const MarkerCovariance& covariance);

/// Entries of those that are known well enough to be used.
std::vector<MapEntry> usedEntries(const std::vector<ProvisionalMarker>& markers);

/// What saving a map came to.
struct SavedMap {
  /// What the file has got. Those whose family and id it had already are not among them.
  std::vector<Marker> added;
  /// Whether the file was written.
  bool is_written = false;
};

/// Adds markers to a map file as it is now, with what its user may have written meanwhile. Throws
/// InputError where it cannot be read, understood or replaced; it is then as it was.
SavedMap addToMapFile(const std::string& path, const std::vector<MapEntry>& entries);

/// The text of a file. Throws InputError where it cannot be read.
std::string readTextFile(const std::string& path);

}  // namespace omnitag
