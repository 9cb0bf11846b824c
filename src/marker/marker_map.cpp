#include "omnitag/marker/marker_map.h"

namespace omnitag {

Corners<Eigen::Vector3d> Marker::corners() const {
  const double half = 0.5 * size;
  return {map_from_marker * Eigen::Vector3d(-half, -half, 0.0),
          map_from_marker * Eigen::Vector3d(half, -half, 0.0),
          map_from_marker * Eigen::Vector3d(half, half, 0.0),
          map_from_marker * Eigen::Vector3d(-half, half, 0.0)};
}

std::vector<std::size_t> entriesOf(const MarkerMap& map, const std::string& family, int id) {
  std::vector<std::size_t> entries;
  for (std::size_t i = 0; i < map.markers.size(); ++i) {
    if (map.markers[i].id == id && map.markers[i].family == family) entries.push_back(i);
  }
  return entries;
}

Eigen::Quaterniond uprightOrientation(double yaw, double roll) {
  // At yaw 0 the normal is the map's x axis, and a person who looks at the marker has the map's y
  // axis to the right. So the marker's axes x, y, z are the map's y, z, x.
  const Eigen::Quaterniond map_from_marker_at_yaw_zero(0.5, 0.5, 0.5, 0.5);
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * map_from_marker_at_yaw_zero *
         Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
}

}  // namespace omnitag
