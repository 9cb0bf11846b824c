#include "adjustment/reference_frame.h"

#include <cmath>
#include <optional>

#include "adjustment/map_builder.h"
#include "marker/marker_reader.h"

namespace omnitag {
namespace {

/// The frame of a map that a marker defines: on the floor below its centre, x along its normal's
/// heading, or along its own x axis if it lies.
Pose frameOn(const Marker& marker) {
  constexpr double kLying = 0.7;  // of the normal's height
  const bool is_lying = std::abs(marker.normal().z()) > kLying;
  const Eigen::Vector3d along = marker.map_from_marker.linear().col(is_lying ? 0 : 2);
  return {marker.center().x(), marker.center().y(), std::atan2(along.y(), along.x())};
}

}  // namespace

std::size_t referenceOf(const Recording& recording) {
  for (const RecordedFrame& frame : recording.frames) {
    std::optional<std::size_t> reference;
    double largest = 0.0;
    for (std::size_t r = 0; r < frame.markers.size(); ++r) {
      const auto& marker = frame.markers[r];
      const double edge = meanEdge(frame.input.readings[r].corners);
      if (!marker || !recording.markers[*marker].is_placed || edge <= largest) continue;
      largest = edge;
      reference = marker;
    }
    if (reference) return *reference;
  }
  throw DegenerateRecording("no marker could be placed: drive past the markers, slowly");
}

void transformTo(std::size_t reference, Recording* recording) {
  const Pose new_from_old = inverse(frameOn(recording->markers[reference].marker));
  for (RecordedFrame& frame : recording->frames) {
    if (frame.map_from_base) frame.map_from_base->pose = new_from_old * frame.map_from_base->pose;
  }
  for (RecordedMarker& marker : recording->markers) {
    if (!marker.is_placed) continue;
    marker.marker.map_from_marker = new_from_old.toIsometry() * marker.marker.map_from_marker;
  }
}

}  // namespace omnitag
