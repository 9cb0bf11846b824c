#include "localization/glance_search.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "common/stopwatch.h"
#include "localization/frame_search.h"
#include "localization/look_around.h"
#include "localization/pose_confirmation.h"
#include "marker/glance_sectors.h"

namespace omnitag {
namespace {

/// At most this many of the largest markers are read over all sectors: more hardly help in finding
/// the others.
constexpr std::size_t kAtMost = 16;

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

/// Whether what was seen from the pose of a glance shows that it is right, if nothing contradicts.
bool isEnough(const FrameResult& seen) {
  const int accepted = seen.acceptedMarkers();
  return accepted > 2 || (accepted == 2 && seen.predicted.size() == 2);
}

/// Whether all markers of the map that were read are at their projections from a pose.
bool areInPlace(const std::vector<MarkerReading>& readings, const TrackingTools& tools,
                const MountedCamera& camera, const Pose& map_from_base) {
  return std::all_of(readings.begin(), readings.end(), [&](const MarkerReading& reading) {
    return entriesOf(tools.map, reading.family, reading.id).empty() ||
           isInPlace(reading, tools, camera, map_from_base);
  });
}

/// Where the map's markers can image.
std::optional<Annulus> annulusToGlanceAt(const TrackingTools& tools, const MountedCamera& camera) {
  const LocalizerConfig& config = tools.config;
  if (!config.motion.isOnFloor()) return annulusOfEverything(camera);
  return annulusOfMarkers(tools.index.heights(), camera, config.visibility.max_range,
                          config.look_around);
}

}  // namespace

std::optional<PoseEstimate> glance(const TrackingTools& tools, const Frame& frame,
                                   const MountedCamera& camera, FrameResult* result) {
  const LocalizerConfig& config = tools.config;
  const GlanceReader& reader = tools.glance_reader;
  const ViewWarper& warper = tools.reader.warper();
  if (!config.look_around.glance || config.exploring_views > 0) return std::nullopt;
  const std::optional<Annulus> annulus = annulusToGlanceAt(tools, camera);
  if (!annulus) return std::nullopt;
  Stopwatch choice;
  const std::vector<Sector> sectors = sectorsToGlanceAt(
      tools.readable.get(), *annulus, camera.model().imagePlane(), config.look_around.overlap);
  result->timings.predict += choice.lap();
  for (std::size_t i = 0; i < reader.count(); ++i) {
    Glance seen;
    std::optional<FrameResult> around;
    for (const Sector& sector : sectors) {
      Stopwatch step;
      const GlanceAim aim{*annulus, sector, kAtMost / sectors.size(), true};
      Glance more = reader.read(tools.readable.get(), i, warper, camera.axisUp(), aim);
      result->timings.decode += step.lap();
      if (more.readings.empty()) continue;
      const bool agrees =
          around && areInPlace(more.readings, tools, camera, around->map_from_base->pose);
      add(std::move(more), warper, &seen);
      if (agrees) continue;
      around = confirm(seen, isEnough, tools, frame, camera, &result->timings);
      if (around && isBeyondDoubt(*around)) break;
    }
    if (!around) continue;
    around->timings = result->timings;
    *result = std::move(*around);
    return result->map_from_base;
  }
  return std::nullopt;
}

}  // namespace omnitag
