#pragma once

#include <cstddef>
#include <vector>

#include "marker/marker_index.h"
#include "measurement/frame_equations.h"
#include "omnitag/marker/marker_map.h"
#include "planning/pattern_edges.h"
#include "planning/planning_scene.h"

namespace omnitag {

/// What one image from a pose is expected to show.
struct PosePrediction {
  /// Entries of the map that are recognized.
  std::vector<std::size_t> markers;
  /// The sum of their equations.
  FrameEquations equations;
};

/// Predicts images of a map's markers. Refers to the scene and the map, which must outlive it. Safe
/// to use from several threads at once.
class PosePredictor {
 public:
  /// Throws InputError for a marker whose family or id is unknown.
  PosePredictor(const PlanningScene& scene, const MarkerMap& map);

  PosePrediction predict(const Pose& map_from_base) const;

 private:
  const PlanningScene& scene_;
  const MarkerMap& map_;
  MarkerIndex index_;
  std::vector<PatternEdges> edges_;
};

}  // namespace omnitag
