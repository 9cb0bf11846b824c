#include "marker/map_constraint.h"

#include <algorithm>
#include <cctype>
#include <set>

namespace omnitag {
namespace {

const char* wordOf(MapConstraint::Kind kind) {
  switch (kind) {
    case MapConstraint::Kind::kDistance:
      return "distance";
    case MapConstraint::Kind::kPlane:
      return "plane";
    case MapConstraint::Kind::kVertical:
      return "vertical";
    case MapConstraint::Kind::kHeight:
      break;
  }
  return "height";
}

/// A word that is a whole number is an id.
MarkerReference referenceOf(const std::string& word) {
  const bool is_id =
      !word.empty() && word.size() < 9 && std::all_of(word.begin(), word.end(), [](char c) {
        return std::isdigit(static_cast<unsigned char>(c)) != 0;
      });
  return is_id ? MarkerReference{"", std::stoi(word)} : MarkerReference{word, -1};
}

std::vector<MarkerReference> referencesOf(const YamlReader& entry, const std::string& key,
                                          std::size_t least, std::size_t most) {
  std::vector<MarkerReference> markers;
  for (const std::string& word : entry.texts(key)) markers.push_back(referenceOf(word));
  if (markers.size() < least || markers.size() > most) {
    entry.refuse(key, most == least
                          ? "a list of " + std::to_string(least) + " names or ids"
                          : "a list of at least " + std::to_string(least) + " names or ids");
  }
  std::set<std::string> names;
  for (const MarkerReference& marker : markers) {
    if (!names.insert(marker.text()).second) entry.refuse(key, "each marker once");
  }
  return markers;
}

MapConstraint readConstraint(const YamlReader& entry) {
  constexpr std::size_t kAny = 1000000;
  MapConstraint constraint;
  bool has_value = false;
  if (entry.has("distance")) {
    constraint.kind = MapConstraint::Kind::kDistance;
    constraint.markers = referencesOf(entry, "distance", 2, 2);
    has_value = true;
  } else if (entry.has("plane")) {
    constraint.kind = MapConstraint::Kind::kPlane;
    constraint.markers = referencesOf(entry, "plane", 3, kAny);
  } else if (entry.has("vertical")) {
    constraint.kind = MapConstraint::Kind::kVertical;
    constraint.markers = referencesOf(entry, "vertical", 1, kAny);
  } else if (entry.has("height")) {
    constraint.kind = MapConstraint::Kind::kHeight;
    constraint.markers = {referenceOf(entry.text("height"))};
    has_value = true;
  } else {
    entry.refuse("expected a constraint: distance, plane, vertical or height, found none");
  }
  const std::string kind = wordOf(constraint.kind);
  if (has_value) {
    entry.allowOnly({kind, "value", "deviation"});
    constraint.value = constraint.kind == MapConstraint::Kind::kDistance
                           ? entry.number("value", kPositive)
                           : entry.number("value");
  } else {
    entry.allowOnly({kind, "deviation"});
  }
  constraint.deviation = entry.number("deviation", kPositive);
  return constraint;
}

}  // namespace

std::vector<MapConstraint> readConstraints(const YamlReader& map) {
  std::vector<MapConstraint> constraints;
  if (!map.has("constraints")) return constraints;
  for (const YamlReader& entry : map.mappings("constraints")) {
    constraints.push_back(readConstraint(entry));
  }
  return constraints;
}

std::vector<MapConstraint> loadConstraints(const std::string& path) {
  return readConstraints(YamlReader::fromFile(path));
}

std::string MapConstraint::text() const {
  std::string names;
  for (const MarkerReference& marker : markers) {
    names += (names.empty() ? "" : ", ") + marker.text();
  }
  return std::string(wordOf(kind)) + " of " + names;
}

}  // namespace omnitag
