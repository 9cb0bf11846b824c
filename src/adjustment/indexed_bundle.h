#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "omnitag/adjustment/bundle_adjustment.h"
#include "omnitag/adjustment/map_builder.h"
#include "recording.h"

namespace omnitag {

/// m (x and y) and rad: standard deviations of what odometry tells of a motion.
Eigen::Vector3d odometryDeviations(const Pose& motion, const MotionModelConfig& config);

/// The recording's frames with a pose and its placed markers as one problem; `frame_indices` and
/// `marker_indices` name what the bundle's frames and landmarks are. Readings that are off by more
/// than a marker that moved would be are left out. The seed is held, and `held_frame`, where given.
struct IndexedBundle {
  Bundle bundle;
  std::vector<std::size_t> frame_indices;
  std::vector<std::size_t> marker_indices;
  std::vector<ReadingPlace> readings;
};
IndexedBundle bundleOf(const Recording& recording, std::optional<std::size_t> held_frame,
                       const MapBuilderConfig& config);

/// Adjusts all, and puts the result into the recording.
void adjust(IndexedBundle* indexed, Recording* recording, const BundleConfig& config);

BundleConfig bundleConfig(const MapBuilderConfig& config);

}  // namespace omnitag
