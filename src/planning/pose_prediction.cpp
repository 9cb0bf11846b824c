#include "planning/pose_prediction.h"

#include "planning/expected_information.h"
#include "planning/sight.h"

namespace omnitag {

PosePredictor::PosePredictor(const PlanningScene& scene, const MarkerMap& map)
    : scene_(scene), map_(map), index_(map), edges_(edgesOf(map)) {}

PosePrediction PosePredictor::predict(const Pose& map_from_base) const {
  const Eigen::Vector3d viewpoint = scene_.camera.mapFromCamera(map_from_base).translation();
  const double range = scene_.config.localizer.visibility.max_range;
  PosePrediction prediction;
  for (const std::size_t entry : index_.within(range, viewpoint)) {
    if (!isRecognized(scene_, map_, entry, edges_[entry], map_from_base)) continue;
    const auto equations =
        expectedEquations(scene_, map_.markers[entry], edges_[entry], map_from_base);
    if (!equations) continue;
    prediction.markers.push_back(entry);
    prediction.equations.add(*equations, 1.0);
  }
  return prediction;
}

}  // namespace omnitag
