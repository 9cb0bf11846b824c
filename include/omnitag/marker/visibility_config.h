#pragma once

#include "omnitag/common/angle.h"

namespace omnitag {

class YamlReader;

/// Which markers are worth looking for, and how far around their predicted places.
struct VisibilityConfig {
  /// m, from the camera to the marker.
  double max_range = 20.0;
  /// rad, between the marker's normal and the direction to the camera.
  double max_incidence = radians(75.0);
  /// Pixels, least length of the marker's longest edge in the panorama to look for it, and for the
  /// decoder to be able to read it.
  double min_edge_pixels = 8.0;
  double min_decodable_edge_pixels = 12.0;
  /// Margin that a view leaves around a marker, in standard deviations due to the predicted pose,
  /// the marker's place and the camera's error.
  double margin_deviations = 3.5;
  /// Pixels of the panorama, least margin that a view leaves.
  double min_margin_pixels = 2.0;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
VisibilityConfig readVisibilityConfig(const YamlReader& reader);

}  // namespace omnitag
