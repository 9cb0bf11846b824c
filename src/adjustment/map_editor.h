#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "marker/marker_selection.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A map file's markers with users' changes, which save() writes to the file. Every operation is
/// done completely or, with an InputError, not at all, and says in words what it did.
class MapEditor {
 public:
  /// Throws what loadMarkerMap() throws.
  explicit MapEditor(const std::string& path);

  const std::string& path() const { return path_; }
  const MarkerMap& map() const { return map_; }
  std::size_t unsavedChanges() const;

  /// Loads the file again and applies the unsaved changes. A change whose marker is no longer in
  /// the file is dropped and named.
  std::string reload();

  /// Loads another file; drops unsaved changes and says how many. The map's frame must be the same
  /// unless `may_change_frame`.
  std::string change(const std::string& path, bool may_change_frame);

  /// `marker`: an empty family, a size of 0 and deviations of 0 are replaced by the map's defaults.
  std::string add(Marker marker);

  /// Removes all selected markers; at least one marker must be left.
  std::string remove(const MarkerSelection& selection);

  std::string move(std::size_t entry, const Eigen::Isometry3d& map_from_marker);

  /// Writes the changes into the file as it now is; the rest of it stays byte for byte.
  std::string save();

 private:
  /// The file's entry that an entry of map_ comes from; none for an added one.
  using Origin = std::optional<std::size_t>;
  void load(const std::string& path);
  bool isMoved(std::size_t entry) const;
  /// The file's entries that are no longer in map_.
  std::vector<std::size_t> removed() const;

  std::string path_;
  MarkerMap file_;
  MarkerMap map_;
  std::vector<Origin> origins_;
};

/// How one map differs from another, in words: which markers were added, removed or changed.
std::string differences(const MarkerMap& before, const MarkerMap& after);

}  // namespace omnitag
