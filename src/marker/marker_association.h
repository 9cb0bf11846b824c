#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "marker/marker_prediction.h"
#include "marker/marker_reader.h"
#include "omnitag/marker/association_config.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

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
