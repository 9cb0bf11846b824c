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

/// How closely a reading must match its prediction.
struct AssociationConfig {
  /// Distance of the centres beyond the prediction's own margin, in lengths of the marker's edge.
  double max_offset = 0.5;
  /// Ratio of the sizes, either way.
  double max_scale = 1.5;
  /// rad, rotation between the two in the image.
  double max_roll = radians(30.0);
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
AssociationConfig readAssociationConfig(const YamlReader& reader);

/// The index of the prediction that a reading belongs to, or why there is none.
struct Association {
  std::optional<std::size_t> prediction;
  std::string reason;
};

/// Associates a reading with a prediction: of the same family and id, near the predicted place, of
/// the predicted size and roll; the nearest if several fit.
Association associate(const MarkerReading& reading, const std::vector<PredictedMarker>& predictions,
                      const MarkerMap& map, const AssociationConfig& config);

}  // namespace omnitag
