#include "adjustment/mapped_entries.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "adjustment/marker_estimate.h"
#include "common/file_replacement.h"
#include "common/least_deviation.h"
#include "marker/marker_selection.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"

namespace omnitag {

MapEntry mappedEntry(const Marker& marker, const MarkerCovariance& covariance) {
  MarkerEstimate estimate;
  estimate.covariance = covariance;
  const Eigen::Vector3d normal = marker.normal();
  std::array<char, 128> remark{};
  std::snprintf(remark.data(), remark.size(),
                "mapped: faces %.1f deg, tilted %+.1f deg, known to %.1f mm and %.2f deg",
                degrees(std::atan2(normal.y(), normal.x())),
                degrees(std::asin(std::clamp(normal.z(), -1.0, 1.0))),
                1e3 * estimate.positionDeviation(), degrees(estimate.orientationDeviation()));
  MapEntry entry{marker, remark.data()};
  entry.marker.deviation = std::max(kLeastDeviation, estimate.positionDeviation());
  entry.marker.orientation_deviation = std::max(kLeastDeviation, estimate.orientationDeviation());
  return entry;
}

std::vector<MapEntry> usedEntries(const std::vector<ProvisionalMarker>& markers) {
  std::vector<MapEntry> entries;
  for (const ProvisionalMarker& each : markers) {
    if (!each.is_used) continue;
    entries.push_back(mappedEntry(each.estimate.marker, each.estimate.covariance));
  }
  return entries;
}

LearntMap withLearnt(const std::string& text, const std::vector<RefinedMarker>& refined,
                     const std::vector<MapEntry>& added, const std::string& origin) {
  const MarkerMap map = parseMarkerMap(text, origin);
  LearntMap learnt;
  std::vector<EntryChange> changes(map.markers.size());
  for (const RefinedMarker& each : refined) {
    const auto entry = entryLike(map, each.given);
    const bool is_as_given = entry && isSameEntry(each.given, map.markers[*entry]);
    if (!is_as_given || isSameEntry(each.refined, each.given)) continue;
    Marker& marker = changes[*entry].moved.emplace(map.markers[*entry]);
    marker.map_from_marker = each.refined.map_from_marker;
    marker.deviation = each.refined.deviation;
    marker.orientation_deviation = each.refined.orientation_deviation;
    ++learnt.refined;
  }
  std::vector<MapEntry> missing;
  std::copy_if(added.begin(), added.end(), std::back_inserter(missing), [&](const auto& entry) {
    return entriesOf(map, entry.marker.family, entry.marker.id).empty();
  });
  learnt.added = missing.size();
  learnt.text = withChanges(text, changes, missing, origin);
  return learnt;
}

std::string readTextFile(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) throw InputError(path + ": expected a readable file, found none");
  return text;
}

}  // namespace omnitag
