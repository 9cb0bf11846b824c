#pragma once

#include <optional>
#include <string>
#include <vector>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// How people refer to a marker: by its name in the map, an id (`7`), or a family and an
/// id (`tag36h11:7`).
class MarkerSelection {
 public:
  /// Throws InputError for an empty text and for an id that the family does not have.
  explicit MarkerSelection(const std::string& text);

  const std::string& text() const { return text_; }
  /// Whether it is a name, which only a marker of a map has.
  bool isName() const { return !id_; }

  bool matches(const Marker& marker) const;
  /// False for a name.
  bool matches(const std::string& family, int id) const;

 private:
  std::string text_;
  /// Empty: any.
  std::string family_;
  std::optional<int> id_;
};

/// The entries that match a selection.
std::vector<std::size_t> selectedEntries(const MarkerMap& map, const MarkerSelection& selection);

/// What a marker is called in messages: its name, or else its family and id.
std::string displayName(const Marker& marker);

/// The map without the markers that match any of the selections.
MarkerMap withoutMarkers(const MarkerMap& map, const std::vector<MarkerSelection>& ignored);

/// The entry that most likely is this marker in another version of its map: the one with its name
/// or, if it has none, the nearest nameless one of its family and id.
std::optional<std::size_t> entryLike(const MarkerMap& map, const Marker& marker);

}  // namespace omnitag
