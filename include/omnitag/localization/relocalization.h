#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/localization/pose_estimator.h"
#include "omnitag/localization/relocalization_config.h"
#include "omnitag/localization/reprojection.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_reader.h"

namespace omnitag {

/// What a search came to.
struct Relocalization {
  /// Nothing where no pose explains what was read, or more than one does.
  std::optional<PoseEstimate> map_from_base;
  /// In words, why there is no pose; empty where there is one.
  std::string reason;
  ImagingError imaging_error = ImagingError::Zero();
  /// For each reading the entry of the map that the best pose explains it by, and its misfit; none
  /// where it does not.
  std::vector<std::optional<std::size_t>> entries;
  std::vector<Misfit> misfits;
};

/// Finds the robot's pose from markers that were read anywhere, without a prediction. Every marker
/// of the map that a reading may be, and every pose from which that marker looks like it, is a
/// hypothesis, which all other readings judge. One marker is enough where its corners tell the
/// pose; ids may stand on several entries. There is no pose as long as two remain plausible: two
/// that explain as many readings, and, where these are the same readings, about equally well.
///
/// `standing`: what is known without a prediction. A pose explains a reading up to
/// `estimation.max_misfit`.
Relocalization relocalize(const MarkerMap& map, const MountedCamera& camera,
                          const std::vector<MarkerReading>& readings, const PosePrior& standing,
                          const EstimatorConfig& estimation, const RelocalizationConfig& config);

/// Poses from which other markers are looked for, which are to confirm one of them: the one that
/// explains what was read, as above, and for a single marker all from which it looks as it does,
/// the likeliest first, however uncertain they are. None where its id stands on several. The
/// covariance is that of corners.
std::vector<Relocalization> roughPoses(const MarkerMap& map, const MountedCamera& camera,
                                       const std::vector<MarkerReading>& readings,
                                       const PosePrior& standing, const EstimatorConfig& estimation,
                                       const RelocalizationConfig& config);

}  // namespace omnitag
