#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "adjustment/bundle_adjustment.h"
#include "adjustment/map_builder.h"
#include "adjustment/recording.h"

namespace omnitag {

/// Standard deviations of a motion by odometry, in m (x and y) and rad.
Eigen::Vector3d odometryDeviations(const Pose& motion, const MotionModelConfig& config);

/// The recording's frames that have a pose, and its placed markers, as one problem; `frame_indices`
/// and `marker_indices` map the bundle's frames and landmarks to the recording. Leaves out readings
/// that are farther off than a moved marker would be. Markers of the seed have their priors;
/// `held_frame`, if given, is held.
struct IndexedBundle {
  Bundle bundle;
  std::vector<std::size_t> frame_indices;
  std::vector<std::size_t> marker_indices;
  std::vector<ReadingIndex> readings;
};
IndexedBundle bundleOf(const Recording& recording, std::optional<std::size_t> held_frame,
                       const MapBuilderConfig& config);

/// Adjusts everything and writes the result to the recording.
void adjust(IndexedBundle* indexed, Recording* recording, const BundleConfig& config);

BundleConfig bundleConfig(const MapBuilderConfig& config);

}  // namespace omnitag
