#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/pose_estimator.h"
#include "localization/reprojection.h"
#include "marker/marker_reader.h"
#include "omnitag/localization/relocalization_config.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The result of a search.
struct Relocalization {
  /// Nothing if no pose explains the readings, or more than one does.
  std::optional<PoseEstimate> map_from_base;
  /// In words, why there is no pose; empty if there is one.
  std::string reason;
  ImagingError imaging_error = ImagingError::Zero();
  /// For each reading, the map entry that explains it from the best pose, and its misfit; none if
  /// no entry does.
  std::vector<std::optional<std::size_t>> entries;
  std::vector<Misfit> misfits;
};

/// Finds the robot's pose from markers that were read anywhere, without a prediction. For every map
/// entry that a reading may be, each pose from which the entry looks like the reading is a
/// hypothesis, judged by all other readings. One marker is enough if its corners determine the
/// pose; an id may occur at several entries. There is no pose while two remain plausible: two that
/// explain equally many readings and, if these are the same readings, about equally well.
///
/// `standing`: what is known of the pose without a prediction. A pose explains a reading if the
/// misfit is at most `estimation.max_misfit`.
Relocalization relocalize(const MarkerMap& map, const MountedCamera& camera,
                          const std::vector<MarkerReading>& readings, const PosePrior& standing,
                          const EstimatorConfig& estimation, const RelocalizationConfig& config);

/// Poses from which to look for other markers that may confirm one of them: the pose that explains
/// the readings, as above, or for a single marker all poses from which it looks like its reading,
/// the likeliest first, however uncertain. None if the single marker's id occurs at several
/// entries. The covariance is what the corners give.
std::vector<Relocalization> roughPoses(const MarkerMap& map, const MountedCamera& camera,
                                       const std::vector<MarkerReading>& readings,
                                       const PosePrior& standing, const EstimatorConfig& estimation,
                                       const RelocalizationConfig& config);

}  // namespace omnitag
