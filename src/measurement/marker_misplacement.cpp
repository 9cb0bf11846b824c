#include "omnitag/measurement/marker_misplacement.h"

namespace omnitag {

PoseMatrix misplacementOf(const Marker& marker, const Pose& map_from_base, double deviation,
                          double orientation_deviation) {
  // The base, turned back with the marker about its centre, moves by (base - centre) x rotation.
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
  return deviation * deviation * by_position * by_position.transpose() +
         orientation_deviation * orientation_deviation * by_orientation *
             by_orientation.transpose();
}

}  // namespace omnitag
