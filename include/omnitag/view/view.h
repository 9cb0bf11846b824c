#pragma once

#include <cstddef>
#include <opencv2/core/types.hpp>
#include <vector>

namespace omnitag {

/// Part of the panorama to look at: a piece of a ring of the ideal image plane.
struct ViewTarget {
  /// rad, of its middle, about the optical axis.
  double azimuth = 0.0;
  /// rad, to both sides of the azimuth.
  double half_width = 0.0;
  /// Of the ideal image plane.
  double min_radius = 0.0;
  double max_radius = 0.0;
  /// m, from the optical axis to what is looked at.
  double distance = 0.0;
};

/// A quasi-perspective view (the paper's Section 6): the image on a rectangle, parallel to the
/// optical axis, that stands across the direction `azimuth` at `distance`. What is straight in the
/// world is nearly straight in it, and it is never mirrored: up and right in the view are up and
/// right for a person in the room.
struct View {
  /// rad, theta_main.
  double azimuth = 0.0;
  /// m, from the optical axis to the rectangle.
  double distance = 0.0;
  /// m along the optical axis: height of the rectangle's middle row.
  double middle_height = 0.0;
  /// Pixels across a tangent of 1.
  double focal_length = 0.0;
  /// Whether the optical axis points up in the world; turns the view the right way up.
  bool axis_up = false;
  cv::Size size;
  /// Indices of the targets that it covers.
  std::vector<std::size_t> targets;

  /// Azimuth of a column's centre, relative to theta_main (the paper's d theta). Columns run to the
  /// viewer's right, which is clockwise about the upward axis.
  double azimuthOffset(double column) const;

  /// Height of a row's centre on the rectangle, in metres along the optical axis.
  double height(double row) const;

  /// Inverses of the two.
  double column(double azimuth_offset) const;
  double row(double height) const;
};

}  // namespace omnitag
