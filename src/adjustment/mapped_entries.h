#pragma once

#include <string>
#include <vector>

#include "adjustment/map_refinement.h"
#include "adjustment/marker_mapper.h"
#include "adjustment/marker_projection.h"
#include "marker/marker_map_writer.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// An estimated marker as an entry of a map file. Its deviations are those in the worst direction;
/// a remark for the reader states where it faces and how well it is known.
MapEntry mappedEntry(const Marker& marker, const MarkerCovariance& covariance);

/// Entries of the markers that are known well enough to be used.
std::vector<MapEntry> usedEntries(const std::vector<ProvisionalMarker>& markers);

/// The text of a map file with what was learnt.
struct LearntMap {
  std::string text;
  /// The number of markers added to the file, except those whose family and id it already had; and
  /// of its own markers whose places or deviations changed.
  std::size_t added = 0;
  std::size_t refined = 0;

  bool isChanged() const { return added > 0 || refined > 0; }
};

/// `text`: of a map file; `origin` takes the place of its name in errors. Refined markers that the
/// file no longer has where they were given, since somebody edited it meanwhile, are left out.
/// Throws InputError if the text cannot be parsed or changed.
LearntMap withLearnt(const std::string& text, const std::vector<RefinedMarker>& refined,
                     const std::vector<MapEntry>& added, const std::string& origin);

/// The text of a file. Throws InputError if it cannot be read.
std::string readTextFile(const std::string& path);

}  // namespace omnitag
