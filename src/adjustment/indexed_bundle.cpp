#include "adjustment/indexed_bundle.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>

namespace omnitag {
namespace {

/// Lower bounds of odometry's deviations for any motion, in m and rad.
constexpr double kLeastTranslationDeviation = 0.002;
constexpr double kLeastRotationDeviation = 0.002;

bool hasDistance(const MapBuilderConfig& config) {
  return std::any_of(config.constraints.begin(), config.constraints.end(),
                     [](const MapConstraint& constraint) {
                       return constraint.kind == MapConstraint::Kind::kDistance;
                     });
}

}  // namespace

Eigen::Vector3d odometryDeviations(const Pose& motion, const MotionModelConfig& config) {
  const bool is_on_floor = config.isOnFloor();
  const Eigen::Isometry3d isometry = motion.toIsometry();
  const double distance =
      is_on_floor ? std::hypot(motion.x, motion.y) : isometry.translation().norm();
  const double turn =
      is_on_floor ? std::abs(motion.yaw) : Eigen::AngleAxisd(isometry.linear()).angle();
  const double translation = std::hypot(config.odometry_translation_per_metre * distance,
                                        config.odometry_translation_per_rotation * turn);
  const double rotation = std::hypot(config.odometry_rotation_per_rotation * turn,
                                     config.odometry_rotation_per_metre * distance);
  const double least_translation = std::max(translation, kLeastTranslationDeviation);
  return {least_translation, least_translation, std::max(rotation, kLeastRotationDeviation)};
}

namespace {

/// The motion by odometry from a frame to a later one of the same recording.
std::optional<Pose> motionBetween(const RecordedFrame& before, const RecordedFrame& frame) {
  const bool follows = &before != &frame && before.input.recording == frame.input.recording;
  if (!follows || !before.input.odom_from_base || !frame.input.odom_from_base) return std::nullopt;
  return inverse(*before.input.odom_from_base) * *frame.input.odom_from_base;
}

/// The constraints whose markers are all landmarks.
std::vector<PlaceConstraint> constraintsOf(const std::vector<Bundle::Landmark>& landmarks,
                                           const std::vector<MapConstraint>& constraints) {
  std::vector<Marker> markers;
  markers.reserve(landmarks.size());
  for (const Bundle::Landmark& landmark : landmarks) markers.push_back(landmark.marker);
  std::vector<PlaceConstraint> placed;
  for (const MapConstraint& constraint : constraints) {
    const auto of_these = resolved(constraint, markers);
    if (of_these) placed.push_back(*of_these);
  }
  return placed;
}

}  // namespace

BundleConfig bundleConfig(const MapBuilderConfig& config) {
  BundleConfig bundle;
  bundle.estimates_sizes = config.estimates_sizes;
  bundle.is_free = !config.motion.isOnFloor();
  // Height and lean each have a part from the mounting and one from the floor.
  bundle.height_deviation = std::sqrt(2.0) * config.motion.floor.height_deviation;
  bundle.lean_deviation = std::sqrt(2.0) * config.motion.floor.lean_deviation;
  bundle.noise = 1.0;  // whitened by each reading's own covariance
  return bundle;
}

IndexedBundle bundleOf(const Recording& recording, std::optional<std::size_t> held_frame,
                       const MapBuilderConfig& config) {
  constexpr double kMaxOff = 20.0;  // pixels
  IndexedBundle indexed;
  indexed.bundle.model = std::make_shared<CalibrationModel>(recording.camera);
  std::vector<std::size_t> landmark_of(recording.markers.size());
  for (std::size_t m = 0; m < recording.markers.size(); ++m) {
    const RecordedMarker& marker = recording.markers[m];
    if (!marker.is_placed) continue;
    landmark_of[m] = indexed.bundle.landmarks.size();
    indexed.marker_indices.push_back(m);
    // Without a seed, the marker that defines the map's frame sets the scale, unless a distance
    // was measured.
    const bool knows_size = marker.prior.has_value() && (marker.is_seed || !hasDistance(config));
    indexed.bundle.landmarks.push_back({marker.marker, marker.prior, knows_size});
  }
  for (std::size_t f = 0; f < recording.frames.size(); ++f) {
    const RecordedFrame& frame = recording.frames[f];
    if (!frame.map_from_base) continue;
    const std::size_t index = indexed.bundle.frames.size();
    const std::size_t before = indexed.frame_indices.empty() ? f : indexed.frame_indices.back();
    indexed.frame_indices.push_back(f);
    indexed.bundle.frames.push_back({frame.input.base_from_camera, frame.map_from_base->pose,
                                     held_frame == f, frame.input.stamp});
    if (const auto motion = motionBetween(recording.frames[before], frame)) {
      indexed.bundle.motions.push_back(
          {index - 1, index, *motion, odometryDeviations(*motion, config.motion)});
    }
    for (std::size_t r = 0; r < frame.markers.size(); ++r) {
      const auto& marker = frame.markers[r];
      if (!marker || !recording.markers[*marker].is_placed) continue;
      const auto projection =
          projectMarker(recording.markers[*marker].marker, frame.camera, frame.map_from_base->pose);
      const CornerPixels pixels = stacked(frame.input.readings[r].corners);
      if (!projection || (projection->pixels - pixels).norm() > 2.0 * kMaxOff) continue;
      Bundle::Observation observation{
          index, landmark_of[*marker], pixels,
          Eigen::Matrix<double, 8, 8>::Identity() / config.corner_noise};
      if (!frame.aligned.empty() && frame.aligned[r]) {
        observation.pixels = frame.aligned[r]->pixels;
        const Eigen::LLT<Eigen::Matrix<double, 8, 8>> factors(frame.aligned[r]->covariance);
        observation.whitening = factors.matrixL().solve(Eigen::Matrix<double, 8, 8>::Identity());
      }
      indexed.bundle.observations.push_back(observation);
      indexed.readings.push_back({f, r});
    }
  }
  indexed.bundle.constraints = constraintsOf(indexed.bundle.landmarks, config.constraints);
  return indexed;
}

void adjust(IndexedBundle* indexed, Recording* recording, const BundleConfig& config) {
  if (!adjust(&indexed->bundle, config)) return;
  for (std::size_t i = 0; i < indexed->frame_indices.size(); ++i) {
    recording->frames[indexed->frame_indices[i]].map_from_base->pose =
        indexed->bundle.frames[i].map_from_base;
  }
  for (std::size_t i = 0; i < indexed->marker_indices.size(); ++i) {
    recording->markers[indexed->marker_indices[i]].marker = indexed->bundle.landmarks[i].marker;
  }
}

}  // namespace omnitag
