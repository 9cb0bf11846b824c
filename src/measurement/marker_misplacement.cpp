#include "measurement/marker_misplacement.h"

#include <algorithm>
#include <cmath>

namespace omnitag {

Misplacement misplacementOf(const Marker& marker, const CameraModel& camera,
                            double pixels_per_metre, double alignment_deviation) {
  constexpr double kSmallestScale = 1e-3;
  const double deviation = std::hypot(alignment_deviation, camera.uncertainty().local()) /
                           std::max(pixels_per_metre, kSmallestScale);
  return {std::hypot(marker.deviation, deviation),
          std::hypot(marker.orientation_deviation, deviation / marker.size)};
}

PoseMatrix seenFrom(const Pose& map_from_base, const Marker& marker,
                    const Misplacement& misplacement) {
  // Turning the base back about the marker's centre moves the base by (base - centre) x rotation.
  const Eigen::Isometry3d isometry = map_from_base.toIsometry();
  const Eigen::Vector3d from_marker = isometry.translation() - marker.center();
  const Eigen::Matrix3d base_from_map = isometry.linear().transpose();
  Eigen::Matrix<double, 6, 3> by_position;
  Eigen::Matrix<double, 6, 3> by_orientation;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
    by_position.col(axis) = poseVector(-unit, Eigen::Vector3d::Zero());
    by_orientation.col(axis) = poseVector(from_marker.cross(unit), -base_from_map * unit);
  }
  by_position *= misplacement.position;
  by_orientation *= misplacement.orientation;
  return by_position * by_position.transpose() + by_orientation * by_orientation.transpose();
}

}  // namespace omnitag
