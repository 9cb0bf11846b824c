#include "marker/marker_selection.h"

#include <algorithm>
#include <limits>

#include "marker/pattern_picture.h"
#include "marker/tag_family.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// Nothing if a text is not a number.
std::optional<int> idOf(const std::string& text) {
  constexpr std::size_t kMostDigits = 9;
  const bool is_number = !text.empty() && text.size() <= kMostDigits &&
                         text.find_first_not_of("0123456789") == std::string::npos;
  return is_number ? std::optional(std::stoi(text)) : std::nullopt;
}

}  // namespace

MarkerSelection::MarkerSelection(const std::string& text) : text_(text) {
  if (text.empty()) throw InputError("expected a marker's name, id or FAMILY:ID, found nothing");
  const std::size_t colon = text.rfind(':');
  const std::string family = colon == std::string::npos ? "" : text.substr(0, colon);
  const std::optional<int> id = idOf(colon == std::string::npos ? text : text.substr(colon + 1));
  const bool is_known = family == kPictureFamily || tagFamilies().count(family) > 0;
  if (!id || (!family.empty() && !is_known)) return;
  family_ = family;
  id_ = id;
  if (!family_.empty() && family_ != kPictureFamily && *id_ >= tagCount(family_)) {
    throw InputError("'" + text + "': expected an id of " + family_ + ", 0 to " +
                     std::to_string(tagCount(family_) - 1));
  }
}

bool MarkerSelection::matches(const Marker& marker) const {
  return (!marker.name.empty() && marker.name == text_) || matches(marker.family, marker.id);
}

bool MarkerSelection::matches(const std::string& family, int id) const {
  return id_ == id && (family_.empty() || family_ == family);
}

std::vector<std::size_t> selectedEntries(const MarkerMap& map, const MarkerSelection& selection) {
  std::vector<std::size_t> entries;
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    if (selection.matches(map.markers[i])) entries.push_back(i);
  }
  return entries;
}

std::string displayName(const Marker& marker) {
  return marker.name.empty() ? marker.family + ":" + std::to_string(marker.id) : marker.name;
}

MarkerMap withoutMarkers(const MarkerMap& map, const std::vector<MarkerSelection>& ignored) {
  MarkerMap rest = map;
  const auto is_ignored = [&ignored](const Marker& marker) {
    return std::any_of(ignored.begin(), ignored.end(),
                       [&marker](const MarkerSelection& each) { return each.matches(marker); });
  };
  auto& markers = rest.markers;
  markers.erase(std::remove_if(markers.begin(), markers.end(), is_ignored), markers.end());
  return rest;
}

std::optional<std::size_t> entryLike(const MarkerMap& map, const Marker& marker) {
  std::optional<std::size_t> like;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    const Marker& other = map.markers[i];
    if (other.name != marker.name) continue;
    if (!marker.name.empty()) return i;
    const double distance = (other.center() - marker.center()).norm();
    if (other.family != marker.family || other.id != marker.id || distance >= nearest) continue;
    nearest = distance;
    like = i;
  }
  return like;
}

}  // namespace omnitag
