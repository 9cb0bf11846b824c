#include "omnitag/localization/displacement.h"

#include "omnitag/localization/marker_pose.h"

namespace omnitag {

std::optional<DisplacedMarker> displacement(const MarkerMap& map, const MountedCamera& camera,
                                            const std::string& family, int id,
                                            const MarkerObservation& observation,
                                            const Pose2& map_from_base,
                                            const EstimatorConfig& config) {
  std::optional<DisplacedMarker> nearest;
  for (const std::size_t entry : entriesOf(map, family, id)) {
    const MarkerObservation as_entry{entry, observation.corners, observation.center};
    for (const ReprojectionFit& fit :
         posesFromMarker(map, camera, as_entry, config.reprojection, config.max_residual)) {
      // Where the robot would have to be for the marker to be right; seen the other way round, by
      // how much the marker moved.
      const Eigen::Isometry3d moved =
          map_from_base.toIsometry() * fit.map_from_base.pose.toIsometry().inverse();
      const Eigen::Vector3d center = map.markers[entry].center();
      const double distance = (moved * center - center).norm();
      if (!nearest || distance < nearest->distance) nearest = DisplacedMarker{entry, distance};
    }
  }
  return nearest;
}

}  // namespace omnitag
