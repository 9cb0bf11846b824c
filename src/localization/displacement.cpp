#include "localization/displacement.h"

#include "localization/marker_pose.h"

namespace omnitag {

std::optional<DisplacedMarker> displacement(const MarkerMap& map, const MountedCamera& camera,
                                            const std::string& family, int id,
                                            const MarkerObservation& observation,
                                            const Pose& map_from_base, const PosePrior& standing,
                                            const EstimatorConfig& config) {
  std::optional<DisplacedMarker> nearest;
  for (const std::size_t entry : entriesOf(map, family, id)) {
    const MarkerObservation as_entry{entry, observation.corners, observation.center};
    for (const ReprojectionFit& fit : posesFromMarker(map, camera, as_entry, standing, config)) {
      // From the pose at which the marker would be in its place to the actual one: the marker moved
      // by the inverse of the robot's apparent motion.
      const Eigen::Isometry3d moved =
          map_from_base.toIsometry() * fit.map_from_base.pose.toIsometry().inverse();
      const Eigen::Vector3d center = map.markers[entry].center();
      const double distance = (moved * center - center).norm();
      if (!nearest || distance < nearest->distance) nearest = DisplacedMarker{entry, distance};
    }
  }
  return nearest;
}

std::optional<GroupDisplacement> displacement(const MarkerMap& map, const DisplacedGroup& group) {
  if (!group.motion || group.entries.size() < 2) return std::nullopt;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const std::size_t entry : group.entries) {
    middle += map.markers[entry].center() / static_cast<double>(group.entries.size());
  }
  // The motion moves the poses to where the markers would be in their places; the markers moved the
  // other way.
  const Eigen::Isometry3d moved = group.motion->inverse();
  return GroupDisplacement{group.entries, moved * middle - middle, Pose::fromIsometry(moved).yaw};
}

void DisplacementLog::add(const FrameResult& result) {
  for (const MarkerDetection& detection : result.detections) {
    if (detection.accepted) sightings_.erase(*detection.map_entry);
  }
  for (const DisplacedMarker& displaced : result.displaced) {
    Sightings& sightings = sightings_[displaced.map_entry];
    ++sightings.count;
    sightings.mean_distance += (displaced.distance - sightings.mean_distance) / sightings.count;
  }
}

std::vector<DisplacedMarker> DisplacementLog::persistent() const {
  // A localizer measures each marker once per second: these are seconds apart.
  constexpr int kFewestSightings = 3;
  std::vector<DisplacedMarker> persistent;
  for (const auto& [entry, sightings] : sightings_) {
    if (sightings.count >= kFewestSightings) persistent.push_back({entry, sightings.mean_distance});
  }
  return persistent;
}

}  // namespace omnitag
