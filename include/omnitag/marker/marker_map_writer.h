#pragma once

#include <optional>
#include <string>
#include <vector>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A marker that is to stand in a map file, and a remark for people behind it.
struct MapEntry {
  Marker marker;
  std::string remark;
};

/// The text of a new map file. The first marker's family, size and deviations
/// are its defaults.
std::string newMapText(const std::string& frame_id, const std::vector<MapEntry>& entries);

/// The text of a map file with entries added at the end of its list `markers`, in its style. All
/// that stands in it stays byte for byte. `origin` stands for the file name in errors.
///
/// An entry has micrometres and microradians. One that is upright to a microradian has a `yaw` and
/// a `roll`, any other an `orientation`.
///
/// Throws InputError where `text` is no marker map, or where what comes out would not be read back
/// as the old markers and the new ones.
std::string withEntries(const std::string& text, const std::vector<MapEntry>& entries,
                        const std::string& origin);

/// What is to become of an entry of a map file: it stays, goes, or is rewritten.
struct EntryChange {
  bool is_removed = false;
  std::optional<Marker> moved;
};

/// The text of a map file with such changes, one for each of its entries, and with entries added as
/// by withEntries(). What is not changed stays byte for byte; so do remarks behind a changed entry
/// in brackets. Throws what withEntries() throws.
std::string withChanges(const std::string& text, const std::vector<EntryChange>& changes,
                        const std::vector<MapEntry>& added, const std::string& origin);

}  // namespace omnitag
