#pragma once

#include <initializer_list>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "marker/pattern_picture.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// What a detector reads: families of codes by their names, and pictures by their ids.
struct MarkerFamilies {
  MarkerFamilies() = default;
  /// Of codes alone.
  MarkerFamilies(std::initializer_list<std::string> names) : codes(names) {}

  std::set<std::string> codes;
  std::map<int, std::shared_ptr<const PatternPicture>> pictures;

  bool isEmpty() const { return codes.empty() && pictures.empty(); }
};

/// The families of a map's markers, and its default family.
MarkerFamilies familiesOf(const MarkerMap& map);

}  // namespace omnitag
