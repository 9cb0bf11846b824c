#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/common/angle.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_prediction.h"
#include "omnitag/marker/marker_reader.h"

namespace omnitag {

/// How like its prediction a detection must be.
struct AssociationConfig {
  /// Distance of the centres beyond the prediction's own margin, in lengths of the marker's edge.
  double max_offset = 0.5;
  /// Ratio of the sizes, either way.
  double max_scale = 1.5;
  /// rad, turn of the one against the other in the image.
  double max_roll = radians(30.0);
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
AssociationConfig readAssociationConfig(const YamlReader& reader);

/// Which prediction a reading belongs to, as an index, or why to none.
struct Association {
  std::optional<std::size_t> prediction;
  std::string reason;
};

/// Compares a reading with predictions: the same family and id, near where it was expected, at the
/// size and the roll expected. Of several that fit, the nearest.
Association associate(const MarkerReading& reading, const std::vector<PredictedMarker>& predictions,
                      const MarkerMap& map, const AssociationConfig& config);

}  // namespace omnitag
