#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "common/rotation.h"
#include "marker/tag_pattern.h"
#include "omnitag/camera/camera_model.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The plane of a marker's drawing (TagPattern: modules, y down) relative to a robot.
class DrawingPlane {
 public:
  DrawingPlane(const Marker& marker, const TagPattern& pattern, const Pose& map_from_base)
      : half_(0.5 * pattern.width()) {
    const Eigen::Isometry3d isometry = map_from_base.toIsometry();
    // The drawing's y runs down.
    const double modules_per_metre = pattern.widthBetweenCorners() / marker.size;
    const Eigen::Vector3d scale(modules_per_metre, -modules_per_metre, 1.0);
    const Eigen::Isometry3d marker_from_map = marker.map_from_marker.inverse();
    drawing_from_map_ = scale.asDiagonal() * marker_from_map.linear();
    drawing_from_base_ = drawing_from_map_ * isometry.linear();
    translation_ = scale.cwiseProduct(marker_from_map * isometry.translation());
  }

  /// The point where a line of sight meets the plane from its front, if it does.
  std::optional<Eigen::Vector2d> meet(const Ray& in_base) const {
    const Eigen::Vector3d origin = drawing_from_base_ * in_base.origin + translation_;
    const Eigen::Vector3d direction = drawing_from_base_ * in_base.direction;
    if (origin.z() <= 0.0 || direction.z() >= 0.0) return std::nullopt;
    const double range = -origin.z() / direction.z();
    return Eigen::Vector2d(half_ + origin.x() + range * direction.x(),
                           half_ + origin.y() + range * direction.y());
  }

  /// Derivative of meet() with respect to the pose of the base (a PoseVector): the point moves with
  /// the line of sight, which moves with the base, and along it back to the plane. Only valid if
  /// the line of sight meets the plane.
  Eigen::Matrix<double, 2, 6> derivative(const Ray& in_base) const {
    const Eigen::Vector3d origin = drawing_from_base_ * in_base.origin + translation_;
    const Eigen::Vector3d direction = drawing_from_base_ * in_base.direction;
    const double range = -origin.z() / direction.z();
    // Points that turn with the base move by rotation x place.
    const Eigen::Vector3d place = in_base.origin + range * in_base.direction;
    const Eigen::Matrix3d turned = -drawing_from_base_ * crossMatrix(place);
    Eigen::Matrix<double, 3, 6> in_drawing;
    in_drawing << drawing_from_map_.leftCols<2>(), turned.col(2), drawing_from_map_.col(2),
        turned.leftCols<2>();
    return in_drawing.topRows<2>() -
           direction.head<2>() / direction.z() * in_drawing.bottomRows<1>();
  }

 private:
  double half_;
  Eigen::Matrix3d drawing_from_map_;
  Eigen::Matrix3d drawing_from_base_;
  Eigen::Vector3d translation_;
};

}  // namespace omnitag
