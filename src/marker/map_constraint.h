#pragma once

#include <string>
#include <vector>

#include "common/yaml_reader.h"

namespace omnitag {

/// A marker in a constraint of a map file: by its name, or by its id.
struct MarkerReference {
  std::string name;
  int id = -1;

  /// As in the file.
  std::string text() const { return name.empty() ? std::to_string(id) : name; }
};

/// A measurement between markers, and its accuracy.
struct MapConstraint {
  enum class Kind {
    kDistance,  ///< between the centres of two markers (m)
    kPlane,     ///< the centres lie in one plane (m)
    kVertical,  ///< the faces are vertical (rad)
    kHeight,    ///< of the centre over the floor (m)
  };
  Kind kind = Kind::kDistance;
  std::vector<MarkerReference> markers;
  /// m, of a distance or a height.
  double value = 0.0;
  /// Standard deviation, m, or rad for verticals.
  double deviation = 1.0;

  /// For people: "distance of door and 7".
  std::string text() const;
};

/// Reads `constraints:` of a map file; empty if there are none. The file's markers are not checked:
/// a constraint may name a marker that is still to be found. Throws InputError.
std::vector<MapConstraint> readConstraints(const YamlReader& map);
std::vector<MapConstraint> loadConstraints(const std::string& path);

}  // namespace omnitag
