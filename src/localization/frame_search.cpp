#include "frame_search.h"

#include <algorithm>
#include <utility>

#include "omnitag/common/stopwatch.h"
#include "omnitag/localization/look_around.h"

namespace omnitag {

std::vector<View> viewsToSearch(const TrackingTools& tools, const MountedCamera& camera) {
  const LocalizerConfig& config = tools.config;
  const ContourTable& table = tools.reader.warper().table();
  if (config.exploring_views > 0) return viewsOfEverything(camera, table, config.look_around);
  return viewsAllAround(tools.map, camera, table, config.visibility.max_range, config.look_around);
}

std::vector<MarkerReading> lookAround(const TrackingTools& tools, const Frame& frame,
                                      const MountedCamera& camera, FrameResult* result) {
  Stopwatch step;
  result->views.clear();
  result->view_images.clear();
  result->detections.clear();
  std::vector<View> views = viewsToSearch(tools, camera);
  result->timings.predict += step.lap();
  std::vector<MarkerReading> readings =
      withoutRepetitions(readViews(tools.reader, frame.image, std::move(views), result),
                         result->views, tools.reader.warper());
  if (tools.config.exploring_views > 0) result->explored = readings;
  return readings;
}

std::vector<std::size_t> addDetections(const std::vector<MarkerReading>& readings,
                                       const Relocalization& found, const MarkerMap& map,
                                       FrameResult* result) {
  std::vector<std::size_t> explaining;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    MarkerDetection detection = toDetection(readings[i]);
    detection.map_entry = found.entries[i];
    detection.residual = found.residuals[i];
    detection.accepted = found.entries[i].has_value();
    if (entriesOf(map, detection.family, detection.id).empty()) {
      detection.reason = "not in the map";
    } else if (!detection.accepted) {
      detection.reason = found.map_from_base ? "disagrees with the other markers" : found.reason;
    }
    if (detection.accepted) explaining.push_back(*found.entries[i]);
    result->detections.push_back(std::move(detection));
  }
  return explaining;
}

int contradictions(const FrameResult& result, const MarkerMap& map) {
  return static_cast<int>(std::count_if(
      result.detections.begin(), result.detections.end(), [&map](const MarkerDetection& d) {
        return !d.accepted && !entriesOf(map, d.family, d.id).empty();
      }));
}

std::optional<PoseEstimate> glance(const TrackingTools& tools, const Frame& frame,
                                   const MountedCamera& camera, std::size_t turn,
                                   FrameResult* result) {
  const LocalizerConfig& config = tools.config;
  const GlanceReader& reader = tools.glance_reader;
  constexpr std::size_t kEnough = 3;
  // Pixels are asked next: what corners say of the pose is only to be where to look.
  constexpr double kDoubt = 3.0;
  const bool is_asked_for = config.look_around.glance && config.exploring_views == 0;
  for (std::size_t i = 0; is_asked_for && i < reader.count(); ++i) {
    Stopwatch step;
    const Glance seen = reader.read(frame.image, i, tools.reader.warper(), camera.axisUp());
    result->timings.decode += step.lap();
    if (seen.readings.size() < kEnough) continue;
    const Relocalization found =
        relocalize(tools.map, camera, seen.readings, config.estimation.reprojection,
                   config.estimation.max_residual, config.relocalization);
    result->timings.solve += step.lap();
    if (!found.map_from_base) continue;
    FrameResult around = *result;
    around.views = seen.views;
    around.view_images = seen.view_images;
    around.detections.clear();
    const std::size_t explained = addDetections(seen.readings, found, tools.map, &around).size();
    if (explained < kEnough || contradictions(around, tools.map) > 0) continue;
    // Those of the map are found anew from the pose.
    const auto isMapped = [](const MarkerDetection& detection) { return detection.accepted; };
    around.detections.erase(
        std::remove_if(around.detections.begin(), around.detections.end(), isMapped),
        around.detections.end());
    PoseEstimate start = *found.map_from_base;
    start.covariance *= kDoubt * kDoubt;
    around.predicted = predictMarkers(tools.map, camera, start, config.visibility);
    std::optional<PoseEstimate> pose =
        FrameTracker(tools, frame, camera, start, &around).track(turn);
    if (!pose || around.acceptedMarkers() < static_cast<int>(explained)) continue;
    *result = std::move(around);
    return pose;
  }
  return std::nullopt;
}

}  // namespace omnitag
