#pragma once

#include <optional>
#include <string>
#include <vector>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// What people call a marker by: its name in the map, an id (`7`), or a family and an id
/// (`tag36h11:7`).
class MarkerSelection {
 public:
  /// Throws InputError for an empty text and for an id that the family does not have.
  explicit MarkerSelection(const std::string& text);

  const std::string& text() const { return text_; }
  /// Whether it is a name, which only a map's marker has.
  bool isName() const { return !id_; }

  bool matches(const Marker& marker) const;
  /// Never by a name.
  bool matches(const std::string& family, int id) const;

 private:
  std::string text_;
  /// Empty: any.
  std::string family_;
  std::optional<int> id_;
};

/// The entries that a selection means.
std::vector<std::size_t> selectedEntries(const MarkerMap& map, const MarkerSelection& selection);

/// How people are told of a marker: by its name, or by its family and id.
std::string displayName(const Marker& marker);

/// The map without what the selections mean.
MarkerMap withoutMarkers(const MarkerMap& map, const std::vector<MarkerSelection>& ignored);

/// The entry that most likely is the marker in another version of its map: the one of its name, or,
/// where it has none, the nearest without a name of its family and id.
std::optional<std::size_t> entryLike(const MarkerMap& map, const Marker& marker);

}  // namespace omnitag
