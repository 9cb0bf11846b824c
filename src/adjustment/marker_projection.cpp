#include "adjustment/marker_projection.h"

#include <cmath>

namespace omnitag {

Eigen::Matrix3d leftJacobian(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const Eigen::Matrix3d cross = crossMatrix(rotation_vector);
  constexpr double kSmall = 1e-4;  // below, the quotients would lose digits
  if (angle < kSmall) return Eigen::Matrix3d::Identity() + 0.5 * cross + cross * cross / 6.0;
  const double square = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / square * cross +
         (angle - std::sin(angle)) / (square * angle) * cross * cross;
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& map_from_marker,
                        const MarkerIncrement& increment) {
  Eigen::Isometry3d result;
  result.linear() = rotationOf(increment.tail<3>()) * map_from_marker.linear();
  result.translation() = map_from_marker.translation() + increment.head<3>();
  result.makeAffine();
  return result;
}

CornerPixels stacked(const Corners<Eigen::Vector2d>& corners) {
  CornerPixels pixels;
  pixels << corners[0], corners[1], corners[2], corners[3];
  return pixels;
}

std::optional<MarkerProjection> projectMarker(const Marker& marker, const MountedCamera& camera,
                                              const Pose& map_from_base) {
  const Corners<Eigen::Vector3d> corners = marker.corners();
  MarkerProjection projection;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    FrameJacobian by_frame;
    Eigen::Matrix<double, 2, 3> by_point;
    const auto pixel = camera.pixelFromMap(map_from_base, corners[k], &by_frame, &by_point);
    if (!pixel) return std::nullopt;
    const Eigen::Vector3d from_center = corners[k] - marker.center();
    const auto row = static_cast<Eigen::Index>(2 * k);
    projection.pixels.segment<2>(row) = *pixel;
    projection.by_pose.middleRows<2>(row) = by_frame.leftCols<6>();
    projection.by_error.middleRows<2>(row) = by_frame.rightCols<kImagingUnknowns>();
    projection.by_marker.block<2, 3>(row, 0) = by_point;
    projection.by_marker.block<2, 3>(row, 3) = -by_point * crossMatrix(from_center);
    projection.by_size.segment<2>(row) = by_point * from_center / marker.size;
  }
  return projection;
}

}  // namespace omnitag
