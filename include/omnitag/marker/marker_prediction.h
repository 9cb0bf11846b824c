#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/pose.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/marker/marker_index.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/view/view.h"

namespace omnitag {

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

/// The markers that the camera should see: facing it, within range, large enough, and entirely
/// within the optics' field and the image.
std::vector<PredictedMarker> predictMarkers(const MarkerMap& map, const MountedCamera& camera,
                                            const PoseEstimate& map_from_base,
                                            const VisibilityConfig& config);

/// The same with the map's index, which is much faster for a large map.
std::vector<PredictedMarker> predictMarkers(const MarkerMap& map, const MarkerIndex& index,
                                            const MountedCamera& camera,
                                            const PoseEstimate& map_from_base,
                                            const VisibilityConfig& config);

/// The prediction of one marker; nothing if the camera should not see it.
std::optional<PredictedMarker> predictMarker(const MarkerMap& map, std::size_t entry,
                                             const MountedCamera& camera,
                                             const PoseEstimate& map_from_base,
                                             const VisibilityConfig& config);

/// Length of a quadrilateral's longest edge.
double longestEdge(const Corners<Eigen::Vector2d>& corners);

/// The part of the panorama in which to look for a marker: its corners, the white border without
/// which it cannot be read, and its margins.
ViewTarget viewTarget(const PredictedMarker& marker, const CameraModel& camera);

}  // namespace omnitag
