#include "omnitag/adjustment/mapped_entries.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "omnitag/adjustment/marker_estimate.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "omnitag/common/file_replacement.h"
#include "omnitag/marker/marker_map_file.h"

namespace omnitag {

MapEntry mappedEntry(const Marker& marker, const MarkerCovariance& covariance) {
  constexpr double kLastDigit = 1e-6;  // of a map file, m and rad
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
  entry.marker.deviation = std::max(kLastDigit, estimate.positionDeviation());
  entry.marker.orientation_deviation = std::max(kLastDigit, estimate.orientationDeviation());
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

SavedMap addToMapFile(const std::string& path, const std::vector<MapEntry>& entries) {
  const std::string text = readTextFile(path);
  const MarkerMap map = parseMarkerMap(text, path);
  std::vector<MapEntry> added;
  std::copy_if(entries.begin(), entries.end(), std::back_inserter(added),
               [&](const MapEntry& entry) {
                 return entriesOf(map, entry.marker.family, entry.marker.id).empty();
               });
  SavedMap saved;
  if (added.empty()) return saved;
  replaceFile(path, withEntries(text, added, path));
  saved.is_written = true;
  for (const MapEntry& entry : added) saved.added.push_back(entry.marker);
  return saved;
}

std::string readTextFile(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) throw InputError(path + ": expected a readable file, found none");
  return text;
}

}  // namespace omnitag
