#include "localization/exploration.h"

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "marker/marker_prediction.h"
#include "view/view_planner.h"

namespace omnitag {
namespace {

double pixelsOf(const View& view) { return view.size.area(); }

double pixelsOf(const std::vector<View>& views) {
  return std::accumulate(views.begin(), views.end(), 0.0,
                         [](double sum, const View& view) { return sum + pixelsOf(view); });
}

/// The view around a marker that may be off its place; nothing if it cannot be read.
std::optional<View> viewOf(const MarkerMap& map, std::size_t entry, const MountedCamera& camera,
                           const Pose& map_from_base, const ContourTable& table,
                           const LocalizerConfig& config) {
  auto predicted = predictMarker(map, entry, camera, {map_from_base}, config.visibility);
  if (!predicted) return std::nullopt;
  const double edge = longestEdge(predicted->corners);
  if (edge < config.visibility.min_decodable_edge_pixels) return std::nullopt;
  const Marker& marker = map.markers[entry];
  const double deviation = marker.deviation * edge / marker.size;  // pixels
  predicted->tangential_margin += config.visibility.margin_deviations * deviation;
  predicted->radial_margin += config.visibility.margin_deviations * deviation;
  return planView(viewTarget(*predicted, camera.model()), table,
                  camera.model().imagePlane().scale(), camera.axisUp(), config.view);
}

bool isAmong(const std::vector<MarkerReading>& readings, const Marker& marker) {
  return std::any_of(readings.begin(), readings.end(), [&marker](const MarkerReading& reading) {
    return reading.id == marker.id && reading.family == marker.family;
  });
}

}  // namespace

bool Exploration::wantsGlance(const LocalizerConfig& config) {
  has_glanced_ = config.look_around.glance && (config.exploring_views > 1 || !has_glanced_);
  return has_glanced_;
}

std::vector<View> Exploration::views(const std::vector<View>& all, const MountedCamera& camera,
                                     const Pose& map_from_base, const ContourTable& table,
                                     const std::vector<MarkerReading>& read,
                                     const LocalizerConfig& config) {
  if (all.empty()) return {};
  const double view_pixels = pixelsOf(all) / static_cast<double>(all.size());
  const double frame_pixels = (config.exploring_views - (has_glanced_ ? 1 : 0)) * view_pixels;
  if (!(frame_pixels > 0.0)) return {};
  std::vector<View> views =
      viewsOfSought(0.5 * frame_pixels, camera, map_from_base, table, read, config);
  double left = saved_pixels_ + frame_pixels - pixelsOf(views);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const View& view = all[next_view_ % all.size()];
    if (pixelsOf(view) > left) break;
    views.push_back(view);
    left -= pixelsOf(view);
    ++next_view_;
  }
  // Pixels saved are for the next frame only, and must not pile up.
  saved_pixels_ = std::min(left, view_pixels);
  return views;
}

std::vector<View> Exploration::viewsOfSought(double max_pixels, const MountedCamera& camera,
                                             const Pose& map_from_base, const ContourTable& table,
                                             const std::vector<MarkerReading>& read,
                                             const LocalizerConfig& config) {
  std::vector<View> views;
  double pixels = 0.0;
  const std::size_t count = sought_.markers.size();
  const std::size_t first = next_sought_;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t entry = (first + i) % count;
    if (isAmong(read, sought_.markers[entry])) continue;
    std::optional<View> view = viewOf(sought_, entry, camera, map_from_base, table, config);
    if (!view) continue;
    pixels += pixelsOf(*view);
    if (!views.empty() && pixels > max_pixels) break;
    views.push_back(std::move(*view));
    next_sought_ = entry + 1;
  }
  return views;
}

}  // namespace omnitag
