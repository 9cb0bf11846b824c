#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "frame_steps.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/relocalization.h"

namespace omnitag {

/// The views in which markers are looked for that are not expected.
std::vector<View> viewsToSearch(const TrackingTools& tools, const MountedCamera& camera,
                                const LookAroundConfig& config);

/// Reads all of these views; they, and nothing else, are then in the result.
std::vector<MarkerReading> lookAround(const TrackingTools& tools, const MountedCamera& camera,
                                      FrameResult* result);

/// Adds what a search read, and returns the entries that its pose stands on.
std::vector<std::size_t> addDetections(const TrackingTools& tools,
                                       const std::vector<MarkerReading>& readings,
                                       const Relocalization& found, FrameResult* result);

/// Why a marker without an entry is not accepted. One that is explored will have an entry.
const char* whyUnknown(const LocalizerConfig& config);

/// Whether a marker of the map is read at its projection from a pose, to about a module.
bool isInPlace(const MarkerReading& reading, const TrackingTools& tools,
               const MountedCamera& camera, const Pose& map_from_base);

/// The entries that the frame's pose stands on.
std::vector<std::size_t> acceptedEntries(const FrameResult& result);

/// The markers that the frame's pose stands on, as they were measured.
std::vector<MarkerObservation> acceptedObservations(const FrameResult& result);

/// Rejects what was accepted.
void rejectAccepted(const char* reason, FrameResult* result);

/// How many detections are of the map's markers and yet not accepted, though it is not known that
/// they hang elsewhere.
int contradictions(const FrameResult& result, const MarkerMap& map);

/// Sets how far the markers are from their projections by the frame's pose; NaN without one.
void setResiduals(const TrackingTools& tools, const MountedCamera& camera, FrameResult* result);

/// A pose that a search found by the markers at the entries `decoded`, made more exact by those
/// that no view around was right to decode: they are recognized at their projections.
PoseEstimate withUndecoded(const TrackingTools& tools, const Frame& frame,
                           const MountedCamera& camera, const PoseEstimate& found,
                           const std::vector<std::size_t>& decoded, const PosePrior& prior,
                           FrameResult* result);

}  // namespace omnitag
