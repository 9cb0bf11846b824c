#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core/types.hpp>
#include <optional>
#include <vector>

#include "omnitag/camera/camera_model.h"

namespace omnitag {

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
