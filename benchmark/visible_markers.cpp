#include "visible_markers.h"

#include <algorithm>

#include "camera/mounted_camera.h"
#include "marker/marker_prediction.h"
#include "marker/marker_reader.h"
#include "marker/tag_pattern.h"
#include "omnitag/marker/visibility_config.h"

namespace omnitag {
namespace {

bool isSame(const PredictedMarker& marker, const MarkerMap& map, const FoundMarker& found) {
  const Marker& mapped = map.markers[marker.map_entry];
  return found.family == mapped.family && found.id == mapped.id &&
         (found.center - marker.center).norm() <= 0.5 * meanEdge(marker.corners);
}

}  // namespace

std::vector<PredictedMarker> visibleMarkers(const RecordedSequence& sequence, std::size_t frame,
                                            double max_incidence) {
  VisibilityConfig all;
  all.max_incidence = max_incidence;
  all.min_edge_pixels = 0.0;
  const MountedCamera camera(sequence.camera, sequence.frames[frame].base_from_camera);
  return predictMarkers(sequence.map, camera, {sequence.truth[frame]}, all);
}

double tangentialWidth(const PredictedMarker& marker, const RecordedSequence& sequence) {
  const Eigen::Vector2d from_axis = marker.center - sequence.camera->imagePlane().principalPoint();
  const Eigen::Vector2d tangent = Eigen::Vector2d(-from_axis.y(), from_axis.x()).normalized();
  const auto& corners = marker.corners;
  const Eigen::Vector2d right = 0.5 * (corners[1] - corners[0] + corners[2] - corners[3]);
  const Eigen::Vector2d up = 0.5 * (corners[3] - corners[0] + corners[2] - corners[1]);
  const Marker& mapped = sequence.map.markers[marker.map_entry];
  return std::max(std::abs(right.dot(tangent)), std::abs(up.dot(tangent))) /
         TagPattern(mapped).widthBetweenCorners();
}

std::vector<FoundMarker> foundMarkers(const FrameResult& result) {
  std::vector<FoundMarker> found;
  for (const MarkerDetection& detection : result.detections) {
    if (detection.accepted) found.push_back({detection.family, detection.id, detection.center});
  }
  return found;
}

std::vector<std::optional<double>> offsetsOfFound(const std::vector<PredictedMarker>& markers,
                                                  const MarkerMap& map,
                                                  const std::vector<FoundMarker>& found) {
  std::vector<std::optional<double>> offsets;
  for (const PredictedMarker& marker : markers) {
    const auto one = std::find_if(found.begin(), found.end(), [&](const FoundMarker& candidate) {
      return isSame(marker, map, candidate);
    });
    offsets.push_back(one != found.end() ? std::optional((one->center - marker.center).norm())
                                         : std::nullopt);
  }
  return offsets;
}

int countFound(const std::vector<PredictedMarker>& markers, const MarkerMap& map,
               const std::vector<FoundMarker>& found) {
  const auto offsets = offsetsOfFound(markers, map, found);
  return static_cast<int>(std::count_if(offsets.begin(), offsets.end(),
                                        [](const auto& offset) { return offset.has_value(); }));
}

int countStrangers(const std::vector<PredictedMarker>& markers, const MarkerMap& map,
                   const std::vector<FoundMarker>& found) {
  return static_cast<int>(std::count_if(found.begin(), found.end(), [&](const FoundMarker& one) {
    return std::none_of(markers.begin(), markers.end(),
                        [&](const PredictedMarker& marker) { return isSame(marker, map, one); });
  }));
}

}  // namespace omnitag
