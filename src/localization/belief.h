#pragma once

#include <vector>

#include "camera/mounted_camera.h"
#include "localization/branch.h"
#include "localization/evidence.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Judges the branches of a frame by what all of them saw. Each remembers it, and those that are
/// nearly as likely as the likeliest, which comes first, are kept. Of branches with the same pose,
/// only the likeliest is kept.
std::vector<Branch> judged(std::vector<Branch> branches, const MountedCamera& camera,
                           const Evidence& evidence);

/// The result to report from the remaining branches: the likeliest, with a covariance that covers
/// the others, or without a pose if these are too far off.
FrameResult reported(const std::vector<Branch>& branches, const MarkerMap& map,
                     const EvidenceConfig& config);

}  // namespace omnitag
