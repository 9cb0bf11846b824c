#include "adjustment/map_growth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "adjustment/indexed_bundle.h"
#include "localization/marker_pose.h"
#include "localization/pose_estimator.h"
#include "localization/relocalization.h"
#include "marker/marker_reader.h"

namespace omnitag {
namespace {

MarkerEstimateConfig estimateConfig(const MapBuilderConfig& config) {
  return {config.corner_noise, config.estimates_sizes};
}

/// Assigns to each reading of a seed's id the entry that images there, if there is one.
void assignSeeds(const Recording& recording, RecordedFrame* frame) {
  for (std::size_t r = 0; r < frame->markers.size(); ++r) {
    const MarkerReading& reading = frame->input.readings[r];
    double nearest = 0.5 * meanEdge(reading.corners);
    for (std::size_t m = 0; m < recording.markers.size() && recording.markers[m].is_seed; ++m) {
      const Marker& marker = recording.markers[m].marker;
      if (marker.id != reading.id || marker.family != reading.family) continue;
      const auto pixel = frame->camera.pixelFromMap(frame->map_from_base->pose, marker.center());
      if (!pixel || (*pixel - reading.center).norm() > nearest) continue;
      nearest = (*pixel - reading.center).norm();
      frame->markers[r] = m;
    }
  }
}

/// The frame's observations: readings that belong to a single entry.
std::vector<MarkerObservation> observationsOf(const RecordedFrame& frame, const MarkerMap& map) {
  std::vector<MarkerObservation> observations;
  for (const MarkerReading& reading : frame.input.readings) {
    const std::vector<std::size_t> entries = entriesOf(map, reading.family, reading.id);
    if (entries.size() == 1) {
      observations.push_back({entries.front(), reading.corners, reading.center});
    }
  }
  return observations;
}

EstimatorConfig estimatorFor(const MapBuilderConfig& config) {
  EstimatorConfig estimator;
  estimator.kind = EstimatorKind::kReprojection;
  // `max_residual` is for both coordinates of a corner.
  estimator.max_misfit =
      config.max_residual / (std::sqrt(2.0) * estimator.reprojection.poor_corner_noise);
  return estimator;
}

/// A pose predicted from a neighbour by odometry, which distinguishes the two optima of a
/// single marker.
std::optional<PoseEstimate> poseFromNeighbour(const Recording& recording, std::size_t index,
                                              const MarkerMap& map,
                                              const MapBuilderConfig& config) {
  const RecordedFrame& frame = recording.frames[index];
  for (const std::size_t neighbour : {index - 1, index + 1}) {  // off the end for the first
    if (neighbour >= recording.frames.size()) continue;
    const RecordedFrame& other = recording.frames[neighbour];
    const bool is_tied = other.input.odom_from_base && frame.input.odom_from_base &&
                         other.input.recording == frame.input.recording;
    if (!other.map_from_base || !is_tied) continue;
    const Pose motion = inverse(*other.input.odom_from_base) * *frame.input.odom_from_base;
    const Eigen::Vector3d deviations = 3.0 * odometryDeviations(motion, config.motion);
    PoseEstimate prior{other.map_from_base->pose * motion, other.map_from_base->covariance};
    prior.covariance.diagonal().head<3>() += deviations.cwiseAbs2();
    if (!config.motion.isOnFloor()) {
      const Eigen::Vector3d off_floor(deviations[0], deviations[2], deviations[2]);
      prior.covariance.diagonal().tail<3>() += off_floor.cwiseAbs2();
    }
    const auto solution = estimatePose(map, frame.camera, observationsOf(frame, map),
                                       PosePrior::about(prior), estimatorFor(config));
    const bool is_seen = solution && std::find(solution->used.begin(), solution->used.end(),
                                               true) != solution->used.end();
    if (is_seen) return solution->map_from_base;
  }
  return std::nullopt;
}

/// Returns how many frames got a pose.
std::size_t localizeFrames(Recording* recording, const MapBuilderConfig& config) {
  std::vector<std::size_t> indices;
  const MarkerMap map = recording->placedMap(&indices);
  const PosePrior standing = config.motion.isOnFloor() ? PosePrior::upright() : PosePrior{};
  std::size_t count = 0;
  for (std::size_t f = 0; f < recording->frames.size(); ++f) {
    RecordedFrame& frame = recording->frames[f];
    if (frame.map_from_base) continue;
    std::vector<MarkerReading> readings;
    std::copy_if(frame.input.readings.begin(), frame.input.readings.end(),
                 std::back_inserter(readings), [&](const MarkerReading& reading) {
                   return !entriesOf(map, reading.family, reading.id).empty();
                 });
    if (readings.empty()) continue;
    frame.map_from_base = relocalize(map, frame.camera, readings, standing, estimatorFor(config),
                                     config.relocalization)
                              .map_from_base;
    if (!frame.map_from_base) frame.map_from_base = poseFromNeighbour(*recording, f, map, config);
    if (!frame.map_from_base) continue;
    assignSeeds(*recording, &frame);
    ++count;
  }
  return count;
}

bool isSure(const MarkerEstimate& estimate, const MapBuilderConfig& config) {
  // While the map grows, poses, and therefore places, are not yet as exact as they will be.
  constexpr double kSlack = 3.0;
  constexpr double kShare = 0.7;
  return estimate.isUnambiguous() && estimate.agreement() >= kShare &&
         estimate.positionDeviation() <= kSlack * config.max_position_deviation &&
         estimate.orientationDeviation() <= kSlack * config.max_orientation_deviation;
}

/// At most this many of the readings, evenly spread.
std::vector<ReadingIndex> evenly(const std::vector<ReadingIndex>& readings, std::size_t at_most) {
  const std::size_t every = (readings.size() + at_most - 1) / at_most;
  std::vector<ReadingIndex> some;
  for (std::size_t i = 0; i < readings.size(); i += every) some.push_back(readings[i]);
  return some;
}

/// Places markers that enough frames show, and places markers again that had been placed as their
/// mirror image. Returns how many were placed for the first time.
std::size_t placeMarkers(Recording* recording, const MapBuilderConfig& config) {
  std::size_t count = 0;
  for (std::size_t m = 0; m < recording->markers.size(); ++m) {
    RecordedMarker& marker = recording->markers[m];
    if (marker.is_seed) continue;
    constexpr std::size_t kEnough = 40;  // to place a marker by; the adjustment takes all
    const auto sightings = recording->sightings(evenly(recording->readingsOf(m), kEnough));
    if (sightings.size() < static_cast<std::size_t>(config.min_sightings)) continue;
    const auto estimate = estimateMarker(
        marker.marker, {recording->camera}, sightings,
        marker.is_placed ? std::optional(marker.marker) : std::nullopt, estimateConfig(config));
    if (!estimate || !isSure(*estimate, config)) continue;
    if (parallax(estimate->marker.center(), sightings) < config.min_parallax) continue;
    count += marker.is_placed ? 0 : 1;
    marker.is_placed = true;
    marker.marker = estimate->marker;
  }
  return count;
}

}  // namespace

std::size_t startFromOneFrame(Recording* recording, const MapBuilderConfig& config) {
  const auto worth = [](const RecordedFrame& frame) {
    double sum = 0.0;
    for (const MarkerReading& reading : frame.input.readings) sum += meanEdge(reading.corners);
    return sum;
  };
  const auto best = std::max_element(
      recording->frames.begin(), recording->frames.end(),
      [&](const RecordedFrame& a, const RecordedFrame& b) { return worth(a) < worth(b); });
  const auto index = static_cast<std::size_t>(best - recording->frames.begin());
  best->map_from_base = PoseEstimate{};
  for (std::size_t r = 0; r < best->markers.size(); ++r) {
    const auto& marker = best->markers[r];
    if (!marker) continue;
    const auto places = markersFromSighting(recording->markers[*marker].marker, {recording->camera},
                                            recording->sighting({index, r}), config.max_residual);
    if (places.empty()) continue;
    recording->markers[*marker].marker = places.front();
    recording->markers[*marker].is_placed = true;
  }
  return index;
}

void grow(Recording* recording, std::optional<std::size_t> held_frame,
          const MapBuilderConfig& config) {
  // Sizes are estimated only when everything is in its place.
  BundleConfig bundle_config = bundleConfig(config);
  bundle_config.estimates_sizes = false;
  for (;;) {
    std::size_t added = localizeFrames(recording, config);
    added += placeMarkers(recording, config);
    IndexedBundle indexed = bundleOf(*recording, held_frame, config);
    adjust(&indexed, recording, bundle_config);
    if (added == 0) return;
  }
}

}  // namespace omnitag
