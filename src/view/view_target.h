#pragma once

#include <Eigen/Core>
#include <optional>

#include "omnitag/common/angle.h"

namespace omnitag {

/// rad. Within this angle of the optical axis, at either end of it, views face their target: on a
/// rectangle parallel to the axis it would be stretched too much.
constexpr double kNearAxis = radians(35.0);

/// All directions within an angle of one direction.
struct ViewCone {
  /// A unit vector in the optical frame.
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  /// rad.
  double half_angle = 0.0;
  /// Pixels of the panorama per radian, where its resolution is highest.
  double resolution = 0.0;
};

/// Part of the panorama to look at: a piece of a ring of the ideal image plane.
struct ViewTarget {
  /// rad, of its middle, about the optical axis.
  double azimuth = 0.0;
  /// rad, to both sides of the azimuth.
  double half_width = 0.0;
  /// Radii of the ideal image plane.
  double min_radius = 0.0;
  double max_radius = 0.0;
  /// m, from the camera to the target; for a ring, taken as the distance from the axis.
  double distance = 0.0;
  /// Replaces the piece of a ring for a target near the axis, which is no small piece of any ring.
  std::optional<ViewCone> cone = std::nullopt;
};

}  // namespace omnitag
