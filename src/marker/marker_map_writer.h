#pragma once

#include <optional>
#include <string>
#include <vector>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A marker for a map file, and a remark for people, which follows it.
struct MapEntry {
  Marker marker;
  std::string remark;
};

/// The text of a new map file, to be written to `path`. The first marker's family, size and
/// deviations become its defaults. Throws InputError if it would not be read back as these markers.
std::string newMapText(const std::string& frame_id, const std::vector<MapEntry>& entries,
                       const std::string& path);

/// The text of a map file with entries added at the end of its list `markers`, in its style. The
/// existing text is kept byte for byte. `origin` takes the place of the file name in errors.
///
/// Entries are written to micrometres and microradians. A marker that is upright to a microradian
/// has a `yaw` and a `roll`, any other an `orientation`.
///
/// Throws InputError if `text` is not a marker map, or if the result would not be read back as the
/// old markers and the new ones.
std::string withEntries(const std::string& text, const std::vector<MapEntry>& entries,
                        const std::string& origin);

/// Whether a map file would tell two markers apart: not if they differ by its last digits alone.
bool isSameEntry(const Marker& a, const Marker& b);

/// A change of a map file's entry: it is kept, removed, or rewritten.
struct EntryChange {
  bool is_removed = false;
  std::optional<Marker> moved;
};

/// The text of a map file with such changes, one for each of its entries, and with entries added as
/// by withEntries(). Everything unchanged is kept byte for byte, including remarks after a changed
/// entry in brackets. Throws the same as withEntries().
std::string withChanges(const std::string& text, const std::vector<EntryChange>& changes,
                        const std::vector<MapEntry>& added, const std::string& origin);

/// The text of the map file `origin` as it must be at `path`: the same, or a new text if it has
/// pictures and moves to another folder, since their paths are relative to the file. Throws the
/// same as newMapText().
std::string movedMapText(const std::string& text, const std::string& origin,
                         const std::string& path);

}  // namespace omnitag
