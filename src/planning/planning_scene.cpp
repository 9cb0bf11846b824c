#include "planning/planning_scene.h"

#include "localization/motion_model.h"

namespace omnitag {

PosePrior PlanningScene::priorAt(const Pose& map_from_base) const {
  const Eigen::Vector3d deviations(config.place_deviation, config.place_deviation,
                                   config.heading_deviation);
  return MotionModel(config.localizer.motion)
      .standing(std::nullopt)
      .withPlace(map_from_base, deviations.cwiseAbs2().cwiseInverse().asDiagonal());
}

}  // namespace omnitag
