#include "localization/frame_search.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "common/stopwatch.h"
#include "localization/look_around.h"
#include "marker/marker_prediction.h"

namespace omnitag {
namespace {

/// The markers in view of a pose that were not decoded but are recognized.
std::vector<MarkerObservation> recognizeUndecoded(const TrackingTools& tools, const Frame& frame,
                                                  const MountedCamera& camera,
                                                  const PoseEstimate& found,
                                                  const std::vector<std::size_t>& decoded,
                                                  const FrameResult& result) {
  // A marker that was read beside its place must not then be recognized in it.
  const auto wasRejected = [&result](const Marker& marker) {
    return std::any_of(result.detections.begin(), result.detections.end(),
                       [&marker](const MarkerDetection& detection) {
                         return !detection.accepted && detection.id == marker.id &&
                                detection.family == marker.family;
                       });
  };
  std::vector<MarkerObservation> recognized;
  for (const PredictedMarker& marker :
       predictMarkers(tools.map, tools.index, camera, found, tools.config.visibility)) {
    if (std::find(decoded.begin(), decoded.end(), marker.map_entry) != decoded.end() ||
        wasRejected(tools.map.markers[marker.map_entry])) {
      continue;
    }
    const auto observation = recognizeMarker(tools, frame.image, camera, marker.map_entry, found);
    if (observation) recognized.push_back(*observation);
  }
  return recognized;
}

/// A pose aligned with the pixels of all markers; nothing if it disagrees with the pose of the
/// decoded ones, or if a recognized one is off it.
std::optional<PhotometricFit> alignWithAll(const TrackingTools& tools, const Frame& frame,
                                           const MountedCamera& camera, const PoseEstimate& found,
                                           const std::vector<std::size_t>& decoded,
                                           const std::vector<MarkerObservation>& recognized,
                                           const PosePrior& prior) {
  if (recognized.empty()) return std::nullopt;
  std::vector<std::size_t> entries = decoded;
  for (const MarkerObservation& observation : recognized) entries.push_back(observation.map_entry);
  auto aligned = alignWithPixels(tools, frame.image, camera, entries, found.pose, prior);
  if (!aligned || !agree(aligned->map_from_base, found)) return std::nullopt;
  const EstimatorConfig& estimation = tools.config.estimation;
  for (const Misfit& misfit : misfitsAt(tools.map, camera, recognized, aligned->map_from_base.pose,
                                        aligned->imaging_error, estimation.reprojection)) {
    if (misfit.deviations > estimation.max_misfit) return std::nullopt;
  }
  return aligned;
}

}  // namespace

std::vector<View> viewsToSearch(const TrackingTools& tools, const MountedCamera& camera,
                                const LookAroundConfig& config) {
  const LocalizerConfig& all = tools.config;
  const ContourTable& table = tools.reader.warper().table();
  const bool is_anything_possible = all.exploring_views > 0 || !all.motion.isOnFloor();
  if (is_anything_possible) return viewsOfEverything(camera, table, config);
  return viewsAllAround(tools.index.heights(), camera, table, all.visibility.max_range, config);
}

std::vector<MarkerReading> lookAround(const TrackingTools& tools, const MountedCamera& camera,
                                      FrameResult* result) {
  Stopwatch step;
  result->views.clear();
  result->view_images.clear();
  result->detections.clear();
  std::vector<View> views = viewsToSearch(tools, camera, tools.config.look_around);
  result->timings.predict += step.lap();
  std::vector<MarkerReading> readings = withoutRepetitions(
      readViews(tools, std::move(views), result), result->views, tools.reader.warper());
  if (tools.config.exploring_views > 0) result->explored = readings;
  return readings;
}

const char* whyUnknown(const LocalizerConfig& config) {
  return config.exploring_views > 0 ? "not in the map yet" : "not in the map";
}

std::vector<std::size_t> addDetections(const TrackingTools& tools,
                                       const std::vector<MarkerReading>& readings,
                                       const Relocalization& found, FrameResult* result) {
  std::vector<std::size_t> explaining;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    MarkerDetection detection = toDetection(readings[i]);
    detection.map_entry = found.entries[i];
    detection.accepted = found.entries[i].has_value();
    if (entriesOf(tools.map, detection.family, detection.id).empty()) {
      detection.reason = whyUnknown(tools.config);
    } else if (!detection.accepted) {
      detection.reason = found.map_from_base ? "disagrees with the other markers" : found.reason;
    }
    if (detection.accepted) explaining.push_back(*found.entries[i]);
    result->detections.push_back(std::move(detection));
  }
  return explaining;
}

bool isInPlace(const MarkerReading& reading, const TrackingTools& tools,
               const MountedCamera& camera, const Pose& map_from_base) {
  constexpr double kModule = 1.0 / 8.0;  // of the edge
  const EstimatorConfig& estimation = tools.config.estimation;
  const std::vector<std::size_t> entries = entriesOf(tools.map, reading.family, reading.id);
  return std::any_of(entries.begin(), entries.end(), [&](std::size_t entry) {
    const auto place = camera.pixelFromMap(map_from_base, tools.map.markers[entry].center());
    if (!place) return false;
    if ((*place - reading.center).norm() < kModule * meanEdge(reading.corners)) return true;
    const MarkerObservation observation{entry, reading.corners, reading.center};
    return misfitsAt(tools.map, camera, {observation}, map_from_base, ImagingError::Zero(),
                     estimation.reprojection)
               .front()
               .deviations <= estimation.max_misfit;
  });
}

std::vector<std::size_t> acceptedEntries(const FrameResult& result) {
  std::vector<std::size_t> entries;
  for (const MarkerDetection& detection : result.detections) {
    if (detection.accepted) entries.push_back(*detection.map_entry);
  }
  return entries;
}

std::vector<MarkerObservation> acceptedObservations(const FrameResult& result) {
  std::vector<MarkerObservation> observations;
  for (const MarkerDetection& detection : result.detections) {
    if (!detection.accepted) continue;
    observations.push_back({*detection.map_entry, detection.corners, detection.center});
  }
  return observations;
}

void rejectAccepted(const char* reason, FrameResult* result) {
  for (MarkerDetection& detection : result->detections) {
    if (!detection.accepted) continue;
    detection.accepted = false;
    detection.reason = reason;
  }
}

int contradictions(const FrameResult& result, const MarkerMap& map) {
  const auto isKnown = [&result](const MarkerDetection& detection) {
    const auto& elsewhere = result.elsewhere;
    return detection.map_entry &&
           std::find(elsewhere.begin(), elsewhere.end(), *detection.map_entry) != elsewhere.end();
  };
  return static_cast<int>(std::count_if(
      result.detections.begin(), result.detections.end(), [&](const MarkerDetection& detection) {
        return !detection.accepted && !isKnown(detection) &&
               !entriesOf(map, detection.family, detection.id).empty();
      }));
}

void setResiduals(const TrackingTools& tools, const MountedCamera& camera, FrameResult* result) {
  for (MarkerDetection& detection : result->detections) {
    Misfit misfit{std::numeric_limits<double>::quiet_NaN(),
                  std::numeric_limits<double>::quiet_NaN()};
    if (detection.map_entry && result->map_from_base) {
      const MarkerObservation observation{*detection.map_entry, detection.corners,
                                          detection.center};
      misfit = misfitsAt(tools.map, camera, {observation}, result->map_from_base->pose,
                         result->imaging_error, tools.config.estimation.reprojection)
                   .front();
    }
    detection.residual = misfit.residual;
    detection.deviations = misfit.deviations;
  }
}

PoseEstimate withUndecoded(const TrackingTools& tools, const Frame& frame,
                           const MountedCamera& camera, const PoseEstimate& found,
                           const std::vector<std::size_t>& decoded, const PosePrior& prior,
                           FrameResult* result) {
  if (tools.config.estimation.kind != EstimatorKind::kPhotometric) return found;
  Stopwatch step;
  const std::vector<MarkerObservation> recognized =
      recognizeUndecoded(tools, frame, camera, found, decoded, *result);
  result->timings.recognize += step.lap();
  const auto aligned = alignWithAll(tools, frame, camera, found, decoded, recognized, prior);
  result->timings.solve += step.lap();
  if (!aligned) return found;
  for (const MarkerObservation& observation : recognized) {
    MarkerDetection detection = toDetection(observation, tools.map.markers[observation.map_entry]);
    detection.accepted = true;
    result->detections.push_back(std::move(detection));
  }
  result->imaging_error = aligned->imaging_error;
  return aligned->map_from_base;
}

}  // namespace omnitag
