#pragma once

#include <vector>

#include "camera/mounted_camera.h"
#include "localization/account.h"
#include "localization/evidence.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Judges the accounts of a frame by what all of them saw. Each remembers it, and those that are
/// nearly as likely as the likeliest, which comes first, are kept. Of accounts with the same pose,
/// only the likeliest is kept.
std::vector<Account> judged(std::vector<Account> accounts, const MountedCamera& camera,
                            const Evidence& evidence);

/// The result to report from the remaining accounts: the likeliest, with a covariance that covers
/// the others, or without a pose if these are too far off.
FrameResult reported(const std::vector<Account>& accounts, const MarkerMap& map,
                     const EvidenceConfig& config);

}  // namespace omnitag
