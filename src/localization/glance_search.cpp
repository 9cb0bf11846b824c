#include "glance_search.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "frame_search.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/stopwatch.h"
#include "omnitag/localization/look_around.h"

namespace omnitag {
namespace {

/// Of a sector the largest markers, so many: more of them hardly tell more of where to look for the
/// others.
constexpr std::size_t kAtMost = 4;

/// Corners only tell where to look: their covariance is to be modest.
constexpr double kDoubt = 3.0;

/// Where a glance looks one after another: what the first ones show is mostly enough. Neighbours
/// overlap by an angle (rad).
std::vector<Sector> sectorsOf(const Annulus& annulus, double overlap) {
  constexpr int kSectors = 4;
  // A marker at the axis is in no sector.
  if (!(annulus.min_radius > 0.0)) return {Sector{}};
  std::vector<Sector> sectors;
  for (int i = 0; i < kSectors; ++i) {
    sectors.push_back({2.0 * kPi * i / kSectors, kPi / kSectors + 0.5 * overlap});
  }
  return sectors;
}

/// Adds what another sector showed.
void add(Glance more, const ViewWarper& warper, Glance* seen) {
  for (MarkerReading& reading : more.readings) {
    reading.view += seen->views.size();
    seen->readings.push_back(std::move(reading));
  }
  std::move(more.views.begin(), more.views.end(), std::back_inserter(seen->views));
  std::move(more.view_images.begin(), more.view_images.end(),
            std::back_inserter(seen->view_images));
  seen->readings = withoutRepetitions(seen->readings, seen->views, warper);
}

/// Whether what was seen from the pose of a glance tells that it is right, as long as nothing
/// speaks against it.
bool isEnough(const FrameResult& seen) {
  const int accepted = seen.acceptedMarkers();
  return accepted > 2 || (accepted == 2 && seen.predicted.size() == 2);
}

/// Whether nothing that is still unseen could speak against it: what was moved as one is fewer.
bool isBeyondDoubt(const FrameResult& seen) {
  return 2 * static_cast<std::size_t>(seen.acceptedMarkers()) > seen.predicted.size();
}

/// Poses that explain what was read. That of a single marker is to be sharpened.
std::vector<Relocalization> startsFrom(const std::vector<MarkerReading>& readings,
                                       const TrackingTools& tools, const MountedCamera& camera) {
  const LocalizerConfig& config = tools.config;
  if (config.estimation.kind == EstimatorKind::kPhotometric) {
    return roughPoses(tools.map, camera, readings, config.estimation.reprojection,
                      config.estimation.max_residual, config.relocalization);
  }
  Relocalization found = relocalize(tools.map, camera, readings, config.estimation.reprojection,
                                    config.estimation.max_residual, config.relocalization);
  if (!found.map_from_base) return {};
  return {std::move(found)};
}

/// The pose from which to look for all markers. The corners of a single one hardly tell from where
/// it is seen; its pixels do.
PoseEstimate sharpened(PoseEstimate pose, const std::vector<std::size_t>& explaining,
                       const TrackingTools& tools, const cv::Mat& panorama,
                       const MountedCamera& camera) {
  if (explaining.size() == 1 && tools.config.estimation.kind == EstimatorKind::kPhotometric) {
    PhotometricConfig rough = tools.config.estimation.photometric;
    rough.max_final_pixels = rough.max_pixels;
    const auto fit = refinePhotometrically(panorama, tools.map, camera, tools.patterns, explaining,
                                           pose.pose, std::nullopt, rough);
    if (fit) return fit->map_from_base;
  }
  pose.covariance *= kDoubt * kDoubt;
  return pose;
}

/// Whether all markers of the map that were read are where a pose has them.
bool areInPlace(const std::vector<MarkerReading>& readings, const TrackingTools& tools,
                const MountedCamera& camera, const Pose2& map_from_base) {
  return std::all_of(readings.begin(), readings.end(), [&](const MarkerReading& reading) {
    return entriesOf(tools.map, reading.family, reading.id).empty() ||
           isInPlace(reading, tools, camera, map_from_base);
  });
}

/// What is seen from a pose that explains readings; nothing where that does not bear it out. Adds
/// to `timings` what it took.
std::optional<FrameResult> lookFrom(const Relocalization& found, const Glance& seen,
                                    const TrackingTools& tools, const Frame& frame,
                                    const MountedCamera& camera, std::size_t turn,
                                    Timings* timings) {
  FrameResult around;
  around.stamp = frame.stamp;
  // The tracker adds those of all markers where people want to look at them.
  if (!frame.wants_views) {
    around.views = seen.views;
    around.view_images = seen.view_images;
  }
  const std::vector<std::size_t> explaining = addDetections(tools, seen.readings, found, &around);
  if (contradictions(around, tools.map) > 0) return std::nullopt;
  // Those of the map are found anew from the pose.
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
  around.map_from_base = FrameTracker(tools, frame, camera, start, &around).track(turn);
  *timings = around.timings;
  const bool explains_all = around.acceptedMarkers() >= static_cast<int>(explaining.size());
  if (!around.map_from_base || !explains_all || !isEnough(around)) return std::nullopt;
  return around;
}

/// The same from the first of the poses that is borne out.
std::optional<FrameResult> lookFromAny(const Glance& seen, const TrackingTools& tools,
                                       const Frame& frame, const MountedCamera& camera,
                                       std::size_t turn, Timings* timings) {
  Stopwatch step;
  const std::vector<Relocalization> starts = startsFrom(seen.readings, tools, camera);
  timings->solve += step.lap();
  for (const Relocalization& start : starts) {
    auto around = lookFrom(start, seen, tools, frame, camera, turn, timings);
    if (around) return around;
  }
  return std::nullopt;
}

}  // namespace

std::optional<PoseEstimate> glance(const TrackingTools& tools, const Frame& frame,
                                   const MountedCamera& camera, std::size_t turn,
                                   FrameResult* result) {
  const LocalizerConfig& config = tools.config;
  const GlanceReader& reader = tools.glance_reader;
  const ViewWarper& warper = tools.reader.warper();
  if (!config.look_around.glance || config.exploring_views > 0) return std::nullopt;
  const std::optional<Annulus> annulus = annulusOfMarkers(
      tools.index.heights(), camera, config.visibility.max_range, config.look_around);
  if (!annulus) return std::nullopt;
  for (std::size_t i = 0; i < reader.count(); ++i) {
    Glance seen;
    std::optional<FrameResult> around;
    for (const Sector& sector : sectorsOf(*annulus, config.look_around.overlap)) {
      Stopwatch step;
      const GlanceAim aim{*annulus, sector, kAtMost, true};
      Glance more = reader.read(frame.image, i, warper, camera.axisUp(), aim);
      result->timings.decode += step.lap();
      if (more.readings.empty()) continue;
      const bool agrees =
          around && areInPlace(more.readings, tools, camera, around->map_from_base->pose);
      add(std::move(more), warper, &seen);
      if (agrees) continue;
      around = lookFromAny(seen, tools, frame, camera, turn, &result->timings);
      if (around && isBeyondDoubt(*around)) break;
    }
    if (!around) continue;
    around->timings = result->timings;
    *result = std::move(*around);
    return std::exchange(result->map_from_base, std::nullopt);
  }
  return std::nullopt;
}

}  // namespace omnitag
