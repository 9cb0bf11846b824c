#include "localization/pose_confirmation.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "common/stopwatch.h"
#include "localization/frame_search.h"
#include "localization/frame_tracker.h"
#include "localization/relocalization.h"

namespace omnitag {
namespace {

/// Corners only show where to look: their covariance should not look too certain.
constexpr double kDoubt = 3.0;

/// Poses that explain the readings. That of a single marker still needs sharpening.
std::vector<Relocalization> startsFrom(const std::vector<MarkerReading>& readings,
                                       const TrackingTools& tools, const MountedCamera& camera) {
  const LocalizerConfig& config = tools.config;
  if (config.estimation.kind == EstimatorKind::kPhotometric) {
    return roughPoses(tools.map, camera, readings, tools.standing, config.estimation,
                      config.relocalization);
  }
  Relocalization found = relocalize(tools.map, camera, readings, tools.standing, config.estimation,
                                    config.relocalization);
  if (!found.map_from_base) return {};
  return {std::move(found)};
}

/// The pose from which to look for all markers. The corners of a single marker hardly determine
/// where it is seen from; its pixels do.
PoseEstimate sharpened(PoseEstimate pose, const std::vector<std::size_t>& explaining,
                       const TrackingTools& tools, const cv::Mat& panorama,
                       const MountedCamera& camera) {
  if (explaining.size() == 1 && tools.config.estimation.kind == EstimatorKind::kPhotometric) {
    PhotometricConfig rough = tools.config.estimation.photometric;
    rough.max_final_pixels = rough.max_pixels;
    const auto fit = refinePhotometrically(panorama, tools.map, camera, tools.patterns, explaining,
                                           pose.pose, tools.standing, rough);
    if (fit) return fit->map_from_base;
  }
  pose.covariance *= kDoubt * kDoubt;
  return pose;
}

bool isAccepted(std::size_t entry, const FrameResult& seen) {
  return std::any_of(seen.detections.begin(), seen.detections.end(),
                     [entry](const MarkerDetection& detection) {
                       return detection.accepted && detection.map_entry == entry;
                     });
}

/// Whether another pose could associate the same markers with other entries.
bool standsOnReusedIds(const FrameResult& seen, const MarkerMap& map) {
  return std::any_of(
      seen.detections.begin(), seen.detections.end(), [&map](const MarkerDetection& detection) {
        return detection.accepted && entriesOf(map, detection.family, detection.id).size() > 1;
      });
}

/// What is seen from a pose that explains readings; nothing if not all of these are found. Adds the
/// time taken to `timings`.
std::optional<FrameResult> lookFrom(const Relocalization& found, const Glance& seen,
                                    const TrackingTools& tools, const Frame& frame,
                                    const MountedCamera& camera, Timings* timings) {
  FrameResult around;
  around.stamp = frame.stamp;
  around.is_on_floor = tools.config.motion.isOnFloor();
  // The tracker adds views of all markers if people want to look at them.
  if (!frame.wants_views) {
    around.views = seen.views;
    around.view_images = seen.view_images;
  }
  const std::vector<std::size_t> explaining = addDetections(tools, seen.readings, found, &around);
  if (contradictions(around, tools.map) > 0) return std::nullopt;
  // The markers of the map are found again from the pose.
  const auto isMapped = [](const MarkerDetection& detection) { return detection.accepted; };
  around.detections.erase(
      std::remove_if(around.detections.begin(), around.detections.end(), isMapped),
      around.detections.end());
  Stopwatch step;
  const PoseEstimate start =
      sharpened(*found.map_from_base, explaining, tools, frame.image, camera);
  timings->solve += step.lap();
  around.timings = *timings;
  around.predicted = predictMarkers(tools.map, tools.index, camera, start, tools.config.visibility);
  around.map_from_base = FrameTracker(tools, frame, camera, start, false, &around).track();
  *timings = around.timings;
  const bool are_all_found =
      std::all_of(explaining.begin(), explaining.end(),
                  [&around](std::size_t entry) { return isAccepted(entry, around); });
  if (!around.map_from_base || !are_all_found) return std::nullopt;
  return around;
}

/// Whether a marker that was found contradicts a pose, while others that were not found may do so
/// as well.
bool isDisputed(const FrameResult& seen, const TrackingTools& tools) {
  return contradictions(seen, tools.map) > 0 && !isBeyondDoubt(seen);
}

}  // namespace

bool isBeyondDoubt(const FrameResult& seen) {
  std::vector<Misfit> misfits;
  for (const MarkerDetection& detection : seen.detections) {
    if (detection.accepted) misfits.push_back({detection.residual, detection.deviations});
  }
  return 2 * sharplyAgreeing(misfits) > seen.predicted.size();
}

std::optional<FrameResult> confirm(const Glance& seen, bool (*isEnough)(const FrameResult&),
                                   const TrackingTools& tools, const Frame& frame,
                                   const MountedCamera& camera, Timings* timings) {
  Stopwatch step;
  const std::vector<Relocalization> starts = startsFrom(seen.readings, tools, camera);
  timings->solve += step.lap();
  std::optional<FrameResult> confirmed;
  for (const Relocalization& start : starts) {
    auto around = lookFrom(start, seen, tools, frame, camera, timings);
    if (!around || !isEnough(*around) || isDisputed(*around, tools)) continue;
    if (!standsOnReusedIds(*around, tools.map)) return around;
    if (confirmed && !agree(*confirmed->map_from_base, *around->map_from_base)) return std::nullopt;
    if (!confirmed) confirmed = std::move(around);
  }
  return confirmed;
}

}  // namespace omnitag
