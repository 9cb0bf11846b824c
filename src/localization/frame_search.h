#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "localization/frame_steps.h"
#include "localization/relocalization.h"
#include "omnitag/localization/frame_result.h"

namespace omnitag {

/// The views in which to look for markers that are not expected.
std::vector<View> viewsToSearch(const TrackingTools& tools, const MountedCamera& camera,
                                const LookAroundConfig& config);

/// Reads all of these views and puts them, and nothing else, into the result.
std::vector<MarkerReading> lookAround(const TrackingTools& tools, const MountedCamera& camera,
                                      FrameResult* result);

/// Adds the readings of a search as detections; returns the entries that its pose is based on.
std::vector<std::size_t> addDetections(const TrackingTools& tools,
                                       const std::vector<MarkerReading>& readings,
                                       const Relocalization& found, FrameResult* result);

/// Why a marker without an entry is not accepted. While exploring, it will get one.
const char* whyUnknown(const LocalizerConfig& config);

/// Whether a marker of the map was read at its projection from a pose, to within about a module.
bool isInPlace(const MarkerReading& reading, const TrackingTools& tools,
               const MountedCamera& camera, const Pose& map_from_base);

/// The entries that the frame's pose is based on.
std::vector<std::size_t> acceptedEntries(const FrameResult& result);

/// The observations that the frame's pose is based on.
std::vector<MarkerObservation> acceptedObservations(const FrameResult& result);

/// Rejects all accepted detections.
void rejectAccepted(const char* reason, FrameResult* result);

/// How many detections of the map's markers are not accepted although they are not known to hang
/// elsewhere.
int contradictions(const FrameResult& result, const MarkerMap& map);

/// Sets how far the markers are from their projections by the frame's pose; NaN without one.
void setResiduals(const TrackingTools& tools, const MountedCamera& camera, FrameResult* result);

/// Refines a pose that a search found from the markers at the entries `decoded`: recognizes, at
/// their projections, other markers that no view was suited to decode.
PoseEstimate withUndecoded(const TrackingTools& tools, const Frame& frame,
                           const MountedCamera& camera, const PoseEstimate& found,
                           const std::vector<std::size_t>& decoded, const PosePrior& prior,
                           FrameResult* result);

}  // namespace omnitag
