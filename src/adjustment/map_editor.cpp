#include "adjustment/map_editor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adjustment/mapped_entries.h"
#include "common/file_replacement.h"
#include "common/format.h"
#include "marker/marker_map_writer.h"
#include "marker/pattern_picture.h"
#include "marker/tag_family.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"

namespace omnitag {
namespace {

/// The names of some markers for messages, shortened if there are many.
std::string namesOf(const std::vector<Marker>& markers) {
  constexpr std::size_t kMost = 8;
  std::string names;
  for (std::size_t i = 0; i < std::min(markers.size(), kMost); ++i) {
    names += (names.empty() ? "" : ", ") + displayName(markers[i]);
  }
  return markers.size() > kMost ? names + ", ..." : names;
}

std::string countOf(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

bool isElsewhere(const Marker& a, const Marker& b) {
  constexpr double kSame = 1e-6;  // m, and of a rotation matrix
  return !(a.map_from_marker.matrix() - b.map_from_marker.matrix()).isZero(kSame);
}

bool hasOtherPicture(const Marker& a, const Marker& b) {
  if (!a.picture || !b.picture) return a.picture != b.picture;
  return a.picture->name != b.picture->name || a.picture->border != b.picture->border ||
         a.picture->white != b.picture->white;
}

bool isOtherwise(const Marker& a, const Marker& b) {
  return a.family != b.family || a.id != b.id || hasOtherPicture(a, b) || a.name != b.name ||
         a.size != b.size || a.deviation != b.deviation ||
         a.orientation_deviation != b.orientation_deviation || isElsewhere(a, b);
}

void checkName(const MarkerMap& map, const std::string& name) {
  for (const Marker& marker : map.markers) {
    if (!name.empty() && marker.name == name) {
      throw InputError("name: expected one that no other marker has, found '" + name + "'");
    }
  }
}

/// The marker, completed with the map's defaults. Throws InputError if a value is out of range.
Marker completed(Marker marker, const MarkerMap& map) {
  if (marker.family.empty()) marker.family = map.default_family;
  if (marker.family == kPictureFamily) {
    const std::vector<std::size_t> alike = entriesOf(map, marker.family, marker.id);
    if (alike.empty()) {
      throw InputError("id: expected that of a pattern of the map, found " +
                       std::to_string(marker.id));
    }
    marker.picture = map.markers[alike.front()].picture;
  } else if (tagFamilies().count(marker.family) == 0) {
    throw InputError("family: expected one of the AprilTag library, a dictionary of OpenCV, or " +
                     std::string(kPictureFamily) + ", found '" + marker.family + "'");
  } else if (marker.id < 0 || marker.id >= tagCount(marker.family)) {
    throw InputError("id: expected one of " + marker.family + ", 0 to " +
                     std::to_string(tagCount(marker.family) - 1) + ", found " +
                     std::to_string(marker.id));
  }
  const auto complete = [](double* value, double preset, const std::string& key) {
    if (*value == 0.0) *value = preset;
    if (!std::isfinite(*value) || *value < 0.0) {
      throw InputError(key + ": expected a number > 0, or 0 for the map's default, found " +
                       std::to_string(*value));
    }
  };
  complete(&marker.size, map.default_size, "size");
  if (marker.size == 0.0)
    throw InputError("size: expected a number > 0, as the map has no default");
  complete(&marker.deviation, map.default_deviation, "deviation");
  complete(&marker.orientation_deviation, map.default_orientation_deviation,
           "orientation_deviation");
  return marker;
}

}  // namespace

std::string differences(const MarkerMap& before, const MarkerMap& after) {
  std::vector<bool> is_kept(before.markers.size(), false);
  std::vector<Marker> added;
  std::vector<Marker> changed;
  double farthest = 0.0;
  for (const Marker& marker : after.markers) {
    const auto entry = entryLike(before, marker);
    if (!entry || is_kept[*entry]) {
      added.push_back(marker);
      continue;
    }
    is_kept[*entry] = true;
    const Marker& old = before.markers[*entry];
    if (!isOtherwise(old, marker)) continue;
    changed.push_back(marker);
    farthest = std::max(farthest, (old.center() - marker.center()).norm());
  }
  std::vector<Marker> removed;
  for (std::size_t i = 0; i < is_kept.size(); ++i) {
    if (!is_kept[i]) removed.push_back(before.markers[i]);
  }
  std::string words;
  const auto tell = [&words](const std::vector<Marker>& markers, const std::string& what) {
    if (markers.empty()) return;
    words += (words.empty() ? "" : ", ") + std::to_string(markers.size()) + " " + what + " (" +
             namesOf(markers) + ")";
  };
  tell(added, "added");
  tell(removed, "removed");
  tell(changed, format("changed, moved by up to %.3f m", farthest));
  return (words.empty() ? "nothing changed" : words) + "; " +
         countOf(after.markers.size(), "marker");
}

MapEditor::MapEditor(const std::string& path) { load(path); }

void MapEditor::load(const std::string& path) {
  file_ = loadMarkerMap(path);
  path_ = path;
  map_ = file_;
  origins_.clear();
  for (std::size_t i = 0; i < map_.markers.size(); ++i) origins_.emplace_back(i);
}

bool MapEditor::isMoved(std::size_t entry) const {
  const Origin& origin = origins_[entry];
  return origin && isElsewhere(map_.markers[entry], file_.markers[*origin]);
}

std::vector<std::size_t> MapEditor::removed() const {
  std::vector<std::size_t> entries;
  for (std::size_t i = 0; i < file_.markers.size(); ++i) {
    if (std::find(origins_.begin(), origins_.end(), Origin(i)) == origins_.end()) {
      entries.push_back(i);
    }
  }
  return entries;
}

std::size_t MapEditor::unsavedChanges() const {
  std::size_t count = removed().size();
  for (std::size_t i = 0; i < origins_.size(); ++i) {
    if (!origins_[i] || isMoved(i)) ++count;
  }
  return count;
}

std::string MapEditor::reload() {
  MapEditor next(path_);
  if (next.map_.frame_id != map_.frame_id) {
    throw InputError(path_ + ": frame_id: expected " + map_.frame_id + ", as before, found " +
                     next.map_.frame_id);
  }
  std::vector<Marker> dropped;
  for (const std::size_t entry : removed()) {
    const auto like = entryLike(next.map_, file_.markers[entry]);
    if (!like || next.map_.markers.size() == 1) continue;
    next.map_.markers.erase(next.map_.markers.begin() + static_cast<std::ptrdiff_t>(*like));
    next.origins_.erase(next.origins_.begin() + static_cast<std::ptrdiff_t>(*like));
  }
  for (std::size_t i = 0; i < origins_.size(); ++i) {
    const Marker& marker = map_.markers[i];
    if (!origins_[i]) {
      // Markers that the file has got meanwhile are not added again.
      const auto like = entryLike(next.map_, marker);
      if (like && (!marker.name.empty() || !isElsewhere(next.map_.markers[*like], marker)))
        continue;
      next.map_.markers.push_back(marker);
      next.origins_.emplace_back();
    } else if (isMoved(i)) {
      const auto like = entryLike(next.map_, file_.markers[*origins_[i]]);
      if (like) {
        next.map_.markers[*like].map_from_marker = marker.map_from_marker;
      } else {
        dropped.push_back(marker);
      }
    }
  }
  std::string words = path_ + ": " + differences(map_, next.map_);
  if (const std::size_t kept = next.unsavedChanges(); kept > 0) {
    words += "; " + countOf(kept, "unsaved change") + " kept";
  }
  if (!dropped.empty()) words += "; moved, but not in the file any more: " + namesOf(dropped);
  *this = std::move(next);
  return words;
}

std::string MapEditor::change(const std::string& path, bool may_change_frame) {
  MapEditor next(path);
  if (!may_change_frame && next.map_.frame_id != map_.frame_id) {
    throw InputError(path + ": frame_id: expected " + map_.frame_id +
                     ", in which the robot's pose is, found " + next.map_.frame_id);
  }
  std::string words = path + ": " + differences(map_, next.map_);
  if (const std::size_t lost = unsavedChanges(); lost > 0) {
    words += "; " + countOf(lost, "unsaved change") + " of " + path_ + " dropped";
  }
  *this = std::move(next);
  return words;
}

std::string MapEditor::add(Marker marker) {
  checkName(map_, marker.name);
  const MarkerMap before = map_;
  map_.markers.push_back(completed(std::move(marker), map_));
  origins_.emplace_back();
  return differences(before, map_);
}

std::string MapEditor::remove(const MarkerSelection& selection) {
  const std::vector<std::size_t> entries = selectedEntries(map_, selection);
  if (entries.empty()) throw InputError("the map has no marker '" + selection.text() + "'");
  if (entries.size() == map_.markers.size()) {
    throw InputError("'" + selection.text() + "': expected one marker to be left in the map");
  }
  const MarkerMap before = map_;
  for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
    map_.markers.erase(map_.markers.begin() + static_cast<std::ptrdiff_t>(*entry));
    origins_.erase(origins_.begin() + static_cast<std::ptrdiff_t>(*entry));
  }
  return differences(before, map_);
}

std::string MapEditor::move(std::size_t entry, const Eigen::Isometry3d& map_from_marker) {
  if (entry >= map_.markers.size()) throw InputError("the map has no such marker any more");
  const MarkerMap before = map_;
  map_.markers[entry].map_from_marker = map_from_marker;
  return differences(before, map_);
}

std::string MapEditor::save() {
  const std::size_t changes = unsavedChanges();
  if (changes == 0) return path_ + " has all already";
  const std::string text = readTextFile(path_);
  const MarkerMap now = parseMarkerMap(text, path_);
  std::vector<EntryChange> wanted(now.markers.size());
  const auto entryOf = [&](const Marker& marker) {
    const auto entry = entryLike(now, marker);
    if (!entry) throw InputError(path_ + ": has no marker " + displayName(marker) + " any more");
    return *entry;
  };
  for (const std::size_t entry : removed()) {
    if (const auto like = entryLike(now, file_.markers[entry])) wanted[*like].is_removed = true;
  }
  std::vector<MapEntry> added;
  for (std::size_t i = 0; i < origins_.size(); ++i) {
    if (!origins_[i]) {
      checkName(now, map_.markers[i].name);
      added.push_back({map_.markers[i], ""});
    } else if (isMoved(i)) {
      const std::size_t entry = entryOf(file_.markers[*origins_[i]]);
      wanted[entry].moved = now.markers[entry];
      wanted[entry].moved->map_from_marker = map_.markers[i].map_from_marker;
    }
  }
  replaceFile(path_, withChanges(text, wanted, added, path_));
  load(path_);
  return countOf(changes, "change") + " saved in " + path_ + ", the old file is beside it with a ~";
}

}  // namespace omnitag
