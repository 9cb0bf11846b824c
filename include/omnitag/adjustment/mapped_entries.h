#pragma once

#include <string>
#include <vector>

#include "omnitag/adjustment/marker_mapper.h"
#include "omnitag/adjustment/marker_projection.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_map_writer.h"

namespace omnitag {

/// An estimated marker as an entry of a map file. Its deviations are those in the worst direction;
/// a remark for the reader states where it faces and how well it is known.
MapEntry mappedEntry(const Marker& marker, const MarkerCovariance& covariance);

/// Entries of the markers that are known well enough to be used.
std::vector<MapEntry> usedEntries(const std::vector<ProvisionalMarker>& markers);

/// The result of saving a map.
struct SavedMap {
  /// The markers added to the file; not those whose family and id it already had.
  std::vector<Marker> added;
  /// Whether the file was written.
  bool is_written = false;
};

/// Adds markers to a map file as it now is, keeping edits made meanwhile. Throws InputError if it
/// cannot be read, parsed or replaced; it is then unchanged.
SavedMap addToMapFile(const std::string& path, const std::vector<MapEntry>& entries);

/// The text of a file. Throws InputError if it cannot be read.
std::string readTextFile(const std::string& path);

}  // namespace omnitag
