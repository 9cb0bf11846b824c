#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "omnitag/camera/camera_model.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Which markers are worth looking for.
struct VisibilityConfig {
  /// m, from the camera to the marker.
  double max_range = 20.0;
  /// rad, between the marker's normal and the direction to the camera.
  double max_incidence = radians(75.0);
  /// Length of the marker's longest edge in the panorama, in pixels; the decoder reads none below.
  double min_edge_pixels = 10.0;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
VisibilityConfig readVisibilityConfig(const YamlReader& reader);

/// A mapped marker as a pose of the camera lets it appear.
struct PredictedMarker {
  std::size_t map_entry = 0;
  /// Pixels of the panoramic image.
  Corners<Eigen::Vector2d> corners;
  Eigen::Vector2d center;
  /// m, from the optical frame's origin to the marker's centre.
  double range = 0.0;
  /// rad, between the marker's normal and the direction to the camera.
  double incidence = 0.0;
};

/// The markers that the camera should see: facing it, within range, large enough, and whole within
/// the optics' field and the image.
std::vector<PredictedMarker> predictMarkers(const MarkerMap& map, const CameraModel& camera,
                                            const Eigen::Isometry3d& camera_from_map,
                                            const VisibilityConfig& config);

}  // namespace omnitag
