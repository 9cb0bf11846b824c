#include "marker/marker_map_writer.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <utility>

#include "marker/pattern_picture.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"

namespace omnitag {
namespace {

/// To a millionth, or to this many digits, without trailing zeros.
std::string number(double value, int digits = 6) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  std::string result = text.data();
  while (result.back() == '0') result.pop_back();
  if (result.back() == '.') result.pop_back();
  return result == "-0" ? "0" : result;
}

std::string list(const std::vector<double>& values, int digits) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "[" : ", ") + number(value, digits);
  return text + "]";
}

/// `yaw` and `roll` for a marker on a vertical surface, `orientation` for any other.
std::string orientationText(const Marker& marker) {
  constexpr double kMicroradian = 1e-6;
  const Eigen::Matrix3d rotation = marker.map_from_marker.linear();
  if (std::abs(rotation(2, 2)) <= kMicroradian) {
    const double yaw = std::atan2(rotation(1, 2), rotation(0, 2));
    const double roll = std::atan2(rotation(2, 0), rotation(2, 1));
    const bool is_rolled = std::abs(roll) > 0.5 * kMicroradian;
    return "yaw: " + number(yaw) + (is_rolled ? ", roll: " + number(roll) : "");
  }
  const Eigen::Quaterniond q(rotation);
  return "orientation: " + list({q.x(), q.y(), q.z(), q.w()}, 8);
}

std::string quoted(const std::string& text) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << text;
  return emitter.c_str();
}

/// What tells the marker from others.
std::string identityText(const Marker& marker, const MarkerMap& defaults) {
  if (!marker.picture) return "id: " + std::to_string(marker.id);
  const std::string border = number(marker.picture->border);
  return "pattern: " + quoted(marker.picture->name) +
         (border == number(defaults.default_border) ? "" : ", border: " + border);
}

/// `defaults`: the map's, which an entry repeats only if it differs.
std::string entryText(const Marker& marker, const MarkerMap& defaults) {
  std::string text = "{" + identityText(marker, defaults);
  if (!marker.name.empty()) text += ", name: " + quoted(marker.name);
  if (marker.family != defaults.default_family) text += ", family: " + marker.family;
  if (number(marker.size) != number(defaults.default_size))
    text += ", size: " + number(marker.size);
  const Eigen::Vector3d center = marker.center();
  text += ", position: " + list({center.x(), center.y(), center.z()}, 6) + ", " +
          orientationText(marker);
  if (number(marker.deviation) != number(defaults.default_deviation)) {
    text += ", deviation: " + number(marker.deviation);
  }
  if (number(marker.orientation_deviation) != number(defaults.default_orientation_deviation)) {
    text += ", orientation_deviation: " + number(marker.orientation_deviation);
  }
  return text + "}";
}

std::string remarkText(const MapEntry& entry) {
  return entry.remark.empty() ? "" : "  # " + entry.remark;
}

/// The closing quote of a quoted scalar; in single quotes, a doubled one is an escaped one.
std::size_t endOfQuoted(const std::string& text, std::size_t begin) {
  const char quote = text[begin];
  for (std::size_t i = begin + 1; i < text.size(); ++i) {
    const bool is_escaped = quote == '"' ? text[i] == '\\' : text.compare(i, 2, "''") == 0;
    if (is_escaped) {
      ++i;
    } else if (text[i] == quote) {
      return i;
    }
  }
  return text.size();
}

/// The last significant character of a flow sequence or mapping that begins at `begin`, and its
/// closing bracket.
struct FlowEnd {
  std::size_t last = std::string::npos;
  bool has_comma = false;
  std::size_t close = std::string::npos;
};

FlowEnd endOfFlow(const std::string& text, std::size_t begin) {
  FlowEnd end;
  int depth = 0;
  for (std::size_t i = begin; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '#' && i > 0 && std::isspace(static_cast<unsigned char>(text[i - 1])) != 0) {
      i = text.find('\n', i);
      if (i == std::string::npos) return {};
      continue;
    }
    const bool begins_scalar =
        end.last != std::string::npos && std::strchr("[{,:", text[end.last]) != nullptr;
    if (begins_scalar && (c == '"' || c == '\'')) i = endOfQuoted(text, i);
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && --depth == 0) {
      end.close = i;
      return end;
    }
    if (std::isspace(static_cast<unsigned char>(c)) == 0) end = {i, c == ',', std::string::npos};
  }
  return {};
}

std::string insertIntoFlow(const std::string& text, std::size_t begin,
                           const std::vector<std::string>& entries) {
  const FlowEnd end = endOfFlow(text, begin);
  if (end.last == std::string::npos) return text;
  std::string added;
  for (const std::string& entry : entries) {
    added += (added.empty() && end.has_comma ? " " : ", ") + entry;
  }
  return text.substr(0, end.last + 1) + added + text.substr(end.last + 1);
}

/// The beginnings of a text's lines, and its end.
std::vector<std::size_t> lineStarts(const std::string& text) {
  std::vector<std::size_t> starts = {0};
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') starts.push_back(i + 1);
  }
  if (starts.back() != text.size()) starts.push_back(text.size());
  return starts;
}

/// Adds lines after the list's last line that is neither empty nor a comment. `first_line` and
/// `last_line`: those of its first and last item; `end_line`: the first one after the list.
std::string insertIntoBlock(const std::string& text, std::size_t first_line, std::size_t last_line,
                            std::size_t end_line, const std::vector<std::string>& lines) {
  const std::vector<std::size_t> starts = lineStarts(text);
  const std::string indent = text.substr(
      starts[first_line], text.find_first_not_of(" \t", starts[first_line]) - starts[first_line]);
  std::size_t line = last_line;
  for (std::size_t i = last_line + 1; i < end_line && i + 1 < starts.size(); ++i) {
    const std::size_t significant = text.find_first_not_of(" \t\r\n", starts[i]);
    if (significant < starts[i + 1] && text[significant] != '#') line = i;
  }
  const std::string newline = text.find("\r\n") == std::string::npos ? "\n" : "\r\n";
  const std::size_t position = starts[line + 1];
  std::string added = position > 0 && text[position - 1] == '\n' ? "" : newline;
  for (const std::string& each : lines) {
    added.append(indent).append("- ").append(each).append(newline);
  }
  return text.substr(0, position) + added + text.substr(position);
}

/// The first line after the value of `markers`; other keys of the file may follow.
std::size_t lineBehind(const YAML::Node& root, std::size_t last_line, std::size_t line_count) {
  std::size_t end = line_count;
  for (const auto& pair : root) {
    const auto line = static_cast<std::size_t>(pair.first.Mark().line);
    if (line > last_line) end = std::min(end, line);
  }
  return end;
}

/// A part of a text, from `begin` to before `end`.
struct Span {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// An item of the list: a mapping in brackets, or one on lines of its own, which ends at a line
/// that is less indented than its first key.
Span spanOf(const std::string& text, const YAML::Node& item, std::size_t end_line) {
  const auto begin = static_cast<std::size_t>(item.Mark().pos);
  if (item.Style() == YAML::EmitterStyle::Flow) return {begin, endOfFlow(text, begin).close + 1};
  const std::vector<std::size_t> starts = lineStarts(text);
  Span span{begin, begin};
  for (auto line = static_cast<std::size_t>(item.Mark().line);
       line + 1 < starts.size() && line < end_line; ++line) {
    const std::size_t first = text.find_first_not_of(" \t\r\n", starts[line]);
    if (first >= starts[line + 1]) continue;
    const bool is_first = starts[line] <= begin;
    const bool is_less = first - starts[line] < static_cast<std::size_t>(item.Mark().column);
    if (!is_first && is_less && text[first] != '#') break;
    if (!is_first && is_less) continue;
    span.end = text.find_last_not_of("\r\n", starts[line + 1] - 1) + 1;
  }
  return span;
}

/// Everything to remove with an item: its lines or, in brackets, a comma.
Span wholeOf(const std::string& text, const Span& item, bool is_in_brackets) {
  if (!is_in_brackets) {
    const std::size_t before = text.rfind('\n', item.begin);
    const std::size_t behind = text.find('\n', item.end);
    return {before == std::string::npos ? 0 : before + 1,
            behind == std::string::npos ? text.size() : behind + 1};
  }
  const std::size_t behind = text.find_first_not_of(" \t\r\n", item.end);
  if (behind != std::string::npos && text[behind] == ',') {
    return {item.begin, std::min(text.find_first_not_of(" \t", behind + 1), text.size())};
  }
  const std::size_t before = text.find_last_not_of(" \t\r\n", item.begin - 1);
  return {text[before] == ',' ? before : item.begin, item.end};
}

/// Rounding errors of the digits that are written.
constexpr double kTolerance = 2e-6;

/// Whether both have the same id or the same picture, whose id changes with the entries before it.
bool areAlike(const Marker& a, const Marker& b) {
  if (!a.picture || !b.picture) return !a.picture && !b.picture && a.id == b.id;
  return a.picture->name == b.picture->name &&
         std::abs(a.picture->border - b.picture->border) < kTolerance;
}

void checkResult(const std::string& result, const MarkerMap& before,
                 const std::vector<MapEntry>& entries, const std::string& origin) {
  const std::string refusal = origin + ": its list of markers cannot be changed in place";
  MarkerMap after;
  try {
    after = parseMarkerMap(result, origin);
  } catch (const InputError& error) {
    throw InputError(refusal + ": " + error.what());
  }
  bool is_right = after.markers.size() == before.markers.size() + entries.size();
  for (std::size_t i = 0; is_right && i < after.markers.size(); ++i) {
    const bool is_old = i < before.markers.size();
    is_right = isSameEntry(after.markers[i],
                           is_old ? before.markers[i] : entries[i - before.markers.size()].marker);
  }
  if (!is_right) throw InputError(refusal);
}

std::filesystem::path folderOf(const std::string& path) {
  return std::filesystem::weakly_canonical(std::filesystem::absolute(path)).parent_path();
}

/// With pictures named relative to a file.
std::vector<MapEntry> withPicturesFrom(const std::string& path, std::vector<MapEntry> entries) {
  const std::filesystem::path folder = folderOf(path);
  for (MapEntry& entry : entries) {
    std::shared_ptr<const PatternPicture>& picture = entry.marker.picture;
    if (!picture) continue;
    PatternPicture named = *picture;
    named.name = std::filesystem::path(picture->path).lexically_proximate(folder).string();
    picture = std::make_shared<PatternPicture>(std::move(named));
  }
  return entries;
}

}  // namespace

bool isSameEntry(const Marker& a, const Marker& b) {
  return a.family == b.family && areAlike(a, b) && a.name == b.name &&
         std::abs(a.size - b.size) < kTolerance &&
         std::abs(a.deviation - b.deviation) < kTolerance &&
         std::abs(a.orientation_deviation - b.orientation_deviation) < kTolerance &&
         a.map_from_marker.isApprox(b.map_from_marker, kTolerance);
}

std::string newMapText(const std::string& frame_id, const std::vector<MapEntry>& entries,
                       const std::string& path) {
  if (entries.empty()) throw InputError("a map needs a marker");
  const std::vector<MapEntry> named = withPicturesFrom(path, entries);
  const Marker& first = named.front().marker;
  MarkerMap defaults;
  if (first.picture) defaults.default_border = first.picture->border;
  defaults.default_family = first.family;
  defaults.default_size = first.size;
  defaults.default_deviation = first.deviation;
  defaults.default_orientation_deviation = first.orientation_deviation;
  std::string text = "frame_id: " + frame_id + "\nfamily: " + first.family +
                     "\nsize: " + number(first.size) + "\ndeviation: " + number(first.deviation) +
                     "\norientation_deviation: " + number(first.orientation_deviation);
  if (first.picture) text += "\nborder: " + number(first.picture->border);
  text += "\nmarkers:\n";
  for (const MapEntry& entry : named) {
    text += "  - " + entryText(entry.marker, defaults) + remarkText(entry) + "\n";
  }
  checkResult(text, {}, named, path);
  return text;
}

std::string withEntries(const std::string& text, const std::vector<MapEntry>& entries,
                        const std::string& origin) {
  const MarkerMap before = parseMarkerMap(text, origin);
  const YAML::Node root = YAML::Load(text);
  const YAML::Node sequence = root["markers"];
  std::vector<std::string> items;
  items.reserve(entries.size());
  for (const MapEntry& entry : entries) {
    items.push_back(entryText(entry.marker, before));
  }
  std::string result;
  if (sequence.Style() == YAML::EmitterStyle::Flow) {
    result = insertIntoFlow(text, static_cast<std::size_t>(sequence.Mark().pos), items);
  } else {
    for (std::size_t i = 0; i < items.size(); ++i) items[i] += remarkText(entries[i]);
    const auto first = static_cast<std::size_t>(sequence[0].Mark().line);
    const auto last = static_cast<std::size_t>(sequence[sequence.size() - 1].Mark().line);
    const std::size_t end = lineBehind(root, last, lineStarts(text).size());
    result = insertIntoBlock(text, first, last, end, items);
  }
  checkResult(result, before, entries, origin);
  return result;
}

std::string withChanges(const std::string& text, const std::vector<EntryChange>& changes,
                        const std::vector<MapEntry>& added, const std::string& origin) {
  const MarkerMap before = parseMarkerMap(text, origin);
  const YAML::Node root = YAML::Load(text);
  const YAML::Node sequence = root["markers"];
  const bool is_in_brackets = sequence.Style() == YAML::EmitterStyle::Flow;
  const auto last_line = static_cast<std::size_t>(sequence[sequence.size() - 1].Mark().line);
  const std::size_t end_line = lineBehind(root, last_line, lineStarts(text).size());
  std::string result = text;
  std::vector<MapEntry> wanted;
  // From the last to the first, so that earlier positions remain valid.
  for (std::size_t i = before.markers.size(); i-- > 0;) {
    const EntryChange& change = changes.at(i);
    const Span span = spanOf(text, sequence[i], end_line);
    if (change.is_removed) {
      const Span whole = wholeOf(result, span, is_in_brackets);
      result.erase(whole.begin, whole.end - whole.begin);
      continue;
    }
    if (change.moved) {
      result.replace(span.begin, span.end - span.begin, entryText(*change.moved, before));
    }
    wanted.insert(wanted.begin(), {change.moved.value_or(before.markers[i]), ""});
  }
  checkResult(result, {}, wanted, origin);
  return added.empty() ? result : withEntries(result, added, origin);
}

std::string movedMapText(const std::string& text, const std::string& origin,
                         const std::string& path) {
  const MarkerMap map = parseMarkerMap(text, origin);
  std::vector<MapEntry> entries;
  for (const Marker& marker : map.markers) entries.push_back({marker, ""});
  const bool has_pictures = std::any_of(entries.begin(), entries.end(),
                                        [](const MapEntry& each) { return each.marker.picture; });
  if (!has_pictures || folderOf(origin) == folderOf(path)) return text;
  return newMapText(map.frame_id, entries, path);
}

}  // namespace omnitag
