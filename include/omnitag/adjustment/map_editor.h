#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_selection.h"

namespace omnitag {

/// A map file's markers with changes that people have made since, which the file gets when they
/// save them. Every operation is done as a whole or, throwing InputError, not at all; and says in
/// words what it did.
class MapEditor {
 public:
  /// Throws what loadMarkerMap() throws.
  explicit MapEditor(const std::string& path);

  const std::string& path() const { return path_; }
  const MarkerMap& map() const { return map_; }
  std::size_t unsavedChanges() const;

  /// Takes the file as it is now, with the unsaved changes. One whose marker the file does not have
  /// any more is dropped, and named.
  std::string reload();

  /// Takes another file; unsaved changes are dropped, and counted. The frame of the map must be the
  /// same, or `may_change_frame`.
  std::string change(const std::string& path, bool may_change_frame);

  /// `marker`: of an empty family, a size of 0 or deviations of 0, the map's defaults are taken.
  std::string add(Marker marker);

  /// All that are meant, but one marker must be left.
  std::string remove(const MarkerSelection& selection);

  std::string move(std::size_t entry, const Eigen::Isometry3d& map_from_marker);

  /// Writes the changes into the file as it is now; the rest of it stays byte for byte.
  std::string save();

 private:
  /// Of an entry of map_, which of the file's it is; none for one that was added.
  using Origin = std::optional<std::size_t>;
  void load(const std::string& path);
  bool isMoved(std::size_t entry) const;
  /// The file's entries that are in map_ no more.
  std::vector<std::size_t> removed() const;

  std::string path_;
  MarkerMap file_;
  MarkerMap map_;
  std::vector<Origin> origins_;
};

/// How one map differs from another, in words: which markers it has besides, which it lacks, and
/// which hang elsewhere.
std::string differences(const MarkerMap& before, const MarkerMap& after);

}  // namespace omnitag
