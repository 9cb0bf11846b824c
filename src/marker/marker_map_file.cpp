#include "omnitag/marker/marker_map_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "common/yaml_reader.h"
#include "marker/map_constraint.h"
#include "marker/pattern_picture.h"
#include "marker/tag_family.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// The file's top-level defaults, for markers without their own values.
struct Defaults {
  std::optional<std::string> family;
  std::optional<double> size;
  double border = PatternPicture().border;
  double deviation = kSurveyedDeviation;
  double orientation_deviation = kSurveyedOrientationDeviation;
};

std::string readFamily(const YamlReader& reader) {
  std::string known;
  for (const std::string& family : tagFamilies()) known += family + ", ";
  known += kPictureFamily;
  if (!reader.has("family")) reader.refuse("family", "one of " + known + " (or a default)");
  std::string family = reader.text("family");
  if (family != kPictureFamily && tagFamilies().count(family) == 0) {
    reader.refuse("family", "one of " + known);
  }
  return family;
}

double readSize(const YamlReader& reader) {
  if (!reader.has("size")) reader.refuse("size", "a number > 0 (or a default)");
  return reader.number("size", kPositive);
}

int readId(const YamlReader& reader, const std::string& family) {
  for (const std::string key : {"pattern", "border"}) {
    if (reader.has(key)) reader.refuse(key, "none, since " + family + " has ids");
  }
  const int id = reader.integer("id", kNonNegative);
  const int last = tagCount(family) - 1;
  if (id > last) reader.refuse("id", "an id of " + family + ", 0 to " + std::to_string(last));
  return id;
}

void readBorder(const YamlReader& reader, double* border) {
  constexpr Interval kBorder{0.05, 0.4};
  reader.read("border", border, kBorder);
}

/// The pictures of a map, each read once. Their paths are relative to the map's file.
class PictureReader {
 public:
  explicit PictureReader(const std::string& map_file)
      : folder_(std::filesystem::path(map_file).parent_path()) {}

  /// Gives the marker its picture, and as its id the first entry that has this picture.
  void read(const YamlReader& reader, double default_border, int entry, Marker* marker) {
    if (reader.has("id")) reader.refuse("id", "a pattern instead, as the marker is a picture");
    if (!reader.has("pattern")) reader.refuse("pattern", "the path of a pattern file");
    double border = default_border;
    readBorder(reader, &border);
    const std::string name = reader.text("pattern");
    std::error_code error;
    const std::string path = std::filesystem::weakly_canonical(folder_ / name, error).string();
    if (error) reader.refuse("pattern", "the path of a pattern file");
    const auto found = std::find_if(pictures_.begin(), pictures_.end(), [&](const Entry& each) {
      return each.picture->path == path && each.picture->border == border;
    });
    if (found != pictures_.end()) {
      marker->id = found->first_entry;
      marker->picture = found->picture;
      return;
    }
    auto picture = std::make_shared<PatternPicture>(pictureOf(reader, path));
    picture->name = name;
    picture->border = border;
    marker->id = entry;
    marker->picture = picture;
    pictures_.push_back({entry, std::move(picture)});
  }

 private:
  struct Entry {
    int first_entry;
    std::shared_ptr<const PatternPicture> picture;
  };

  static PatternPicture pictureOf(const YamlReader& reader, const std::string& path) {
    try {
      return loadPatternPicture(path);
    } catch (const InputError& error) {
      throw InputError(reader.where("pattern") + ": " + error.what());
    }
  }

  std::filesystem::path folder_;
  std::vector<Entry> pictures_;
};

Eigen::Quaterniond readOrientation(const YamlReader& reader) {
  if (reader.has("yaw") && reader.has("orientation")) {
    reader.refuse("expected either yaw or orientation, found both");
  }
  if (reader.has("yaw")) {
    double roll = 0.0;
    reader.read("roll", &roll);
    return uprightOrientation(reader.number("yaw"), roll);
  }
  if (!reader.has("orientation")) reader.refuse("expected yaw or orientation, found neither");
  if (reader.has("roll")) reader.refuse("expected roll beside yaw only, found it with orientation");

  const std::vector<double> xyzw = reader.numbers("orientation", 4);
  const Eigen::Quaterniond orientation(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  constexpr double kNormTolerance = 1e-3;
  if (std::abs(orientation.norm() - 1.0) > kNormTolerance) {
    reader.refuse(
        "expected orientation to be a quaternion [qx, qy, qz, qw] of norm 1, found norm " +
        std::to_string(orientation.norm()));
  }
  return orientation.normalized();
}

void readDeviations(const YamlReader& reader, double* deviation, double* orientation_deviation) {
  constexpr Interval kRadians{0.0, 0.5 * kPi};
  reader.read("deviation", deviation, kNonNegative);
  reader.read("orientation_deviation", orientation_deviation, kRadians);
}

Marker readMarker(const YamlReader& reader, const Defaults& defaults, int entry,
                  PictureReader* pictures) {
  reader.allowOnly({"id", "pattern", "border", "name", "family", "size", "position", "yaw", "roll",
                    "orientation", "deviation", "orientation_deviation"});
  Marker marker;
  marker.family = defaults.family && !reader.has("family") ? *defaults.family : readFamily(reader);
  if (marker.family == kPictureFamily) {
    pictures->read(reader, defaults.border, entry, &marker);
  } else {
    marker.id = readId(reader, marker.family);
  }
  marker.size = defaults.size && !reader.has("size") ? *defaults.size : readSize(reader);
  if (reader.has("name")) {
    marker.name = reader.text("name");
    if (marker.name.empty()) reader.refuse("name", "a name");
  }
  const std::vector<double> position = reader.numbers("position", 3);
  marker.map_from_marker.translation() << position[0], position[1], position[2];
  marker.map_from_marker.linear() = readOrientation(reader).toRotationMatrix();
  marker.deviation = defaults.deviation;
  marker.orientation_deviation = defaults.orientation_deviation;
  readDeviations(reader, &marker.deviation, &marker.orientation_deviation);
  return marker;
}

MarkerMap readMarkerMap(const YamlReader& reader) {
  reader.allowOnly({"frame_id", "family", "size", "border", "deviation", "orientation_deviation",
                    "markers", "constraints"});
  MarkerMap map;
  reader.read("frame_id", &map.frame_id);
  if (map.frame_id.empty()) reader.refuse("frame_id", "the name of a frame");

  Defaults defaults;
  if (reader.has("family")) defaults.family = readFamily(reader);
  if (reader.has("size")) defaults.size = readSize(reader);
  map.default_family = defaults.family.value_or("");
  map.default_size = defaults.size.value_or(0.0);
  readBorder(reader, &defaults.border);
  map.default_border = defaults.border;
  readDeviations(reader, &defaults.deviation, &defaults.orientation_deviation);
  map.default_deviation = defaults.deviation;
  map.default_orientation_deviation = defaults.orientation_deviation;

  std::set<std::string> names;
  PictureReader pictures(reader.origin());
  for (const YamlReader& entry : reader.mappings("markers")) {
    const auto number = static_cast<int>(map.markers.size());
    map.markers.push_back(readMarker(entry, defaults, number, &pictures));
    const std::string& name = map.markers.back().name;
    if (!name.empty() && !names.insert(name).second) {
      entry.refuse("name", "a name that no other marker has");
    }
  }
  if (map.markers.empty()) reader.refuse("markers", "at least one marker");
  // Only building a map needs constraints, but errors in them should be reported to every user
  // of it.
  readConstraints(reader);
  return map;
}

}  // namespace

MarkerMap loadMarkerMap(const std::string& path) {
  return readMarkerMap(YamlReader::fromFile(path));
}

MarkerMap parseMarkerMap(const std::string& text, const std::string& origin) {
  return readMarkerMap(YamlReader::fromText(text, origin));
}

}  // namespace omnitag
