#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A mapped marker as it should image from a predicted pose of the robot.
struct PredictedMarker {
  std::size_t map_entry = 0;
  /// Pixels of the panorama.
  Corners<Eigen::Vector2d> corners;
  Eigen::Vector2d center;
  /// m, from the optical frame's origin to the marker's centre.
  double range = 0.0;
  /// rad, between the marker's normal and the direction to the camera.
  double incidence = 0.0;
  /// Pixels by which the marker may be away from its predicted place, along the tangent and along
  /// the radius of the panorama.
  double tangential_margin = 0.0;
  double radial_margin = 0.0;
  /// Pixels, standard deviation of a corner's displacement relative to the centre, along each axis.
  double shape_deviation = 0.0;
};

}  // namespace omnitag
