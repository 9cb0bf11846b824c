#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core/types.hpp>
#include <optional>
#include <vector>

#include "omnitag/camera/camera_model.h"
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
  /// Replaces the piece of a ring for a target near the axis, which no small piece would cover.
  std::optional<ViewCone> cone = std::nullopt;
};

/// A quasi-perspective view (the paper's Section 6): the image on a rectangle parallel to the
/// optical axis and perpendicular to the direction `azimuth`, at `distance`. Straight lines of the
/// world are nearly straight in it, and it is never mirrored: up and right in the view are up and
/// right for a person in the room.
///
/// For a target near the axis, the rectangle is turned by `elevation` about the horizontal line
/// through the optical frame's origin, so that it is perpendicular to that direction.
struct View {
  /// rad, theta_main.
  double azimuth = 0.0;
  /// rad, of the direction perpendicular to the rectangle, toward the optical axis's +z; 0 if the
  /// rectangle is parallel to the axis.
  double elevation = 0.0;
  /// m, from the optical axis (before it is turned by `elevation`) to the rectangle.
  double distance = 0.0;
  /// m along the optical axis: height of the rectangle's middle row.
  double middle_height = 0.0;
  /// Pixels per unit of the tangent.
  double focal_length = 0.0;
  /// Whether the optical axis points up in the world; the view is the right way up in both cases.
  bool axis_up = false;
  cv::Size size;
  /// Indices of the targets that it covers.
  std::vector<std::size_t> targets;

  /// Azimuth of a column's centre, relative to theta_main (the paper's d theta). Columns run to the
  /// viewer's right, which is clockwise about the upward axis.
  double azimuthOffset(double column) const;

  /// Height of a row's centre on the rectangle, in metres along the optical axis.
  double height(double row) const;

  /// Inverses of these two.
  double column(double azimuth_offset) const;
  double row(double height) const;

  /// The point of the rectangle at a position of the view, in the optical frame; and the position
  /// at which a line of sight meets the rectangle's plane; nothing if it does not.
  Eigen::Vector3d pointAt(const Eigen::Vector2d& position) const;
  std::optional<Eigen::Vector2d> positionOf(const Ray& ray) const;

 private:
  /// Columns: to the right, up, and forward through the rectangle, in the optical frame.
  Eigen::Matrix3d axes() const;
};

}  // namespace omnitag
