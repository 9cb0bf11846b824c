#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/yaml_reader.h"
#include "omnitag/localization/reprojection.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_reader.h"

namespace omnitag {

/// When a pose that was found without any prediction is believed.
struct RelocalizationConfig {
  /// Pixels of the panorama: standard deviation of a corner when hypotheses are compared. Larger
  /// than what corners have on average, since a small or blurred marker must not decide by chance.
  double corner_noise = 0.15;
  /// Log-likelihood by which the best of several poses that explain the same markers must lead.
  double min_lead = 10.0;
  /// Pixels, RMS over the corners of the only marker that a pose explains.
  double max_residual_of_one = 0.5;
  /// Corrected bits of the only marker that a pose explains.
  int max_hamming_of_one = 1;
  /// m: standard deviation of a pose's position that a single marker may leave.
  double max_deviation_of_one = 0.2;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
RelocalizationConfig readRelocalizationConfig(const YamlReader& reader);

/// What a search came to.
struct Relocalization {
  /// Nothing where no pose explains what was read, or more than one does.
  std::optional<PoseEstimate> map_from_base;
  /// In words, why there is no pose; empty where there is one.
  std::string reason;
  /// For each reading the entry of the map that the best pose explains it by, and its residual
  /// (pixels, RMS over its corners); none where it does not.
  std::vector<std::optional<std::size_t>> entries;
  std::vector<double> residuals;
};

/// Finds the robot's pose from markers that were read anywhere, without a prediction. Every marker
/// of the map that a reading may be, and every pose from which that marker looks like it, is a
/// hypothesis, which all other readings judge. One marker is enough where its corners tell the
/// pose; ids may stand on several entries. There is no pose as long as two remain plausible: two
/// that explain as many readings, and, where these are the same readings, about equally well.
///
/// `max_residual`: pixels, RMS over a marker's corners up to which a pose explains a reading.
Relocalization relocalize(const MarkerMap& map, const MountedCamera& camera,
                          const std::vector<MarkerReading>& readings,
                          const ReprojectionConfig& reprojection, double max_residual,
                          const RelocalizationConfig& config);

/// Poses from which other markers are looked for, which are to confirm one of them: the one that
/// explains what was read, as above, and for a single marker all from which it looks as it does,
/// the likeliest first, however uncertain they are. None where its id stands on several. The
/// covariance is that of corners.
std::vector<Relocalization> roughPoses(const MarkerMap& map, const MountedCamera& camera,
                                       const std::vector<MarkerReading>& readings,
                                       const ReprojectionConfig& reprojection, double max_residual,
                                       const RelocalizationConfig& config);

}  // namespace omnitag
