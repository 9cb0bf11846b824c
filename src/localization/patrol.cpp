#include "localization/patrol.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/stopwatch.h"
#include "localization/frame_search.h"

namespace omnitag {
namespace {

/// s: how long a view that showed a marker elsewhere takes every second turn, until that has been
/// measured repeatedly.
constexpr double kOddViewTime = 3.0;

double largestArea(const std::vector<View>& views) {
  double largest = 0.0;
  for (const View& view : views) largest = std::max(largest, static_cast<double>(view.size.area()));
  return largest;
}

/// The views to patrol, as large as AttentionConfig::max_pixels allows.
std::vector<View> viewsToPatrol(const TrackingTools& tools, const MountedCamera& camera) {
  LookAroundConfig config = tools.config.look_around;
  std::vector<View> views = viewsToSearch(tools, camera, config);
  const double share = tools.config.attention.max_pixels / std::max(largestArea(views), 1.0);
  if (share >= 1.0) return views;
  config.oversampling *= std::sqrt(share);
  return viewsToSearch(tools, camera, config);
}

bool isAmong(const std::vector<MarkerDetection>& detections, const MarkerReading& reading) {
  return std::any_of(detections.begin(), detections.end(), [&](const MarkerDetection& detection) {
    return detection.id == reading.id && detection.family == reading.family &&
           (detection.center - reading.center).norm() < meanEdge(reading.corners);
  });
}

}  // namespace

void Patrol::look(const TrackingTools& tools, const Frame& frame, const MountedCamera& camera,
                  const Pose& map_from_base, FrameResult* result) {
  const double passed = last_stamp_ ? frame.stamp - *last_stamp_ : tools.config.attention.period;
  last_stamp_ = frame.stamp;
  const bool is_exploring = tools.config.exploring_views > 0;
  std::vector<MarkerReading> readings;
  if (is_exploring) {
    if (result->explored.empty()) explore(tools, camera, map_from_base, result);
    readings = result->explored;
  } else {
    credit_ += passed / tools.config.attention.period;
    readings = readNextView(tools, camera, result);
  }
  bool is_odd = false;
  for (const MarkerReading& reading : readings) {
    // A marker that was not expected because it is far away or seen from the side may well be in
    // its place.
    if (isAmong(result->detections, reading) || isInPlace(reading, tools, camera, map_from_base)) {
      continue;
    }
    const bool is_unknown = entriesOf(tools.map, reading.family, reading.id).empty();
    MarkerDetection detection = toDetection(reading);
    detection.reason = is_unknown ? whyUnknown(tools.config) : kElsewhere;
    is_odd = is_odd || !is_unknown;
    result->detections.push_back(std::move(detection));
  }
  const bool is_watched =
      std::any_of(odd_views_.begin(), odd_views_.end(),
                  [this](const OddView& odd) { return odd.index == last_view_; });
  if (is_odd && !is_watched) odd_views_.push_back({last_view_, frame.stamp + kOddViewTime});
}

std::vector<MarkerReading> Patrol::readNextView(const TrackingTools& tools,
                                                const MountedCamera& camera, FrameResult* result) {
  const std::vector<View> views = viewsToPatrol(tools, camera);
  if (views.empty()) return {};
  // Each view has one turn in a period.
  const double price = 1.0 / static_cast<double>(views.size());
  if (credit_ < price) return {};
  credit_ = std::min(credit_ - price, price);
  last_view_ = nextOf(views.size(), result->stamp);
  return readViews(tools, {views[last_view_]}, result);
}

std::size_t Patrol::nextOf(std::size_t count, double stamp) {
  odd_views_.erase(
      std::remove_if(odd_views_.begin(), odd_views_.end(),
                     [&](const OddView& odd) { return odd.index >= count || stamp > odd.until; }),
      odd_views_.end());
  ++looks_;
  if (!odd_views_.empty() && looks_ % 2 == 0) {
    return odd_views_[looks_ / 2 % odd_views_.size()].index;
  }
  return next_view_++ % count;
}

void Patrol::explore(const TrackingTools& tools, const MountedCamera& camera,
                     const Pose& map_from_base, FrameResult* result) {
  const LocalizerConfig& config = tools.config;
  const ViewWarper& warper = tools.reader.warper();
  if (exploration_.wantsGlance(config)) {
    Stopwatch step;
    result->explored =
        tools.glance_reader.read(tools.readable.get(), 0, warper, camera.axisUp()).readings;
    result->timings.decode += step.lap();
  }
  std::vector<View> views =
      exploration_.views(viewsToSearch(tools, camera, config.look_around), camera, map_from_base,
                         warper.table(), result->explored, config);
  const std::vector<MarkerReading> readings =
      withoutRepetitions(readViews(tools, std::move(views), result), result->views, warper);
  result->explored.insert(result->explored.end(), readings.begin(), readings.end());
}

}  // namespace omnitag
