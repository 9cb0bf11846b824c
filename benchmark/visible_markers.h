#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/localization/frame_result.h"
#include "recorded_sequence.h"

namespace omnitag {

/// The mapped markers that a frame's camera sees from where it really is: whole within the ring of
/// the panorama, and turned away from it by at most `max_incidence` (radians), of whatever size.
/// What stands in between is not known.
std::vector<PredictedMarker> visibleMarkers(const RecordedSequence& sequence, std::size_t frame,
                                            double max_incidence);

/// Pixels along the tangent of that edge of a module that runs along it.
double tangentialWidth(const PredictedMarker& marker, const RecordedSequence& sequence);

/// What a method says hangs at a pixel of the panorama, its centre.
struct FoundMarker {
  std::string family;
  int id = 0;
  Eigen::Vector2d center;
};

/// The accepted detections of a frame.
std::vector<FoundMarker> foundMarkers(const FrameResult& result);

/// For each of the markers how far from its place it was found, in pixels: its id, within half an
/// edge. Nothing where it was not found.
std::vector<std::optional<double>> offsetsOfFound(const std::vector<PredictedMarker>& markers,
                                                  const MarkerMap& map,
                                                  const std::vector<FoundMarker>& found);

/// How many of the markers were found.
int countFound(const std::vector<PredictedMarker>& markers, const MarkerMap& map,
               const std::vector<FoundMarker>& found);

/// How many of those found are none of the markers.
int countStrangers(const std::vector<PredictedMarker>& markers, const MarkerMap& map,
                   const std::vector<FoundMarker>& found);

}  // namespace omnitag
