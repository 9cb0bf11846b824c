#include "ros/adjustment_tools/map_output.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "adjustment/map_advice.h"
#include "adjustment/map_alignment.h"
#include "adjustment/mapped_entries.h"
#include "common/format.h"
#include "marker/marker_map_writer.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"

namespace omnitag {
namespace {

const BuiltMarker& markerOf(const AlignPoint& point, const BuiltMap& map) {
  const auto found =
      std::find_if(map.markers.begin(), map.markers.end(), [&point](const BuiltMarker& each) {
        return each.marker.name == point.marker || std::to_string(each.marker.id) == point.marker;
      });
  if (found == map.markers.end()) {
    throw InputError("--align-point: expected a marker of the map, found '" + point.marker + "'");
  }
  return *found;
}

void transform(const Pose& other_from_map, BuiltMap* map) {
  const Eigen::Isometry3d isometry = other_from_map.toIsometry();
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
  turn.topLeftCorner<3, 3>() = isometry.linear();
  turn.bottomRightCorner<3, 3>() = isometry.linear();
  const auto moveOne = [&](BuiltMarker& each) {
    each.marker.map_from_marker = isometry * each.marker.map_from_marker;
    each.covariance = turn * each.covariance * turn.transpose();
    each.is_exact = false;
    // Its deviations are the same in all directions.
    if (each.survey) each.survey->map_from_marker = isometry * each.survey->map_from_marker;
  };
  for (BuiltMarker& each : map->markers) moveOne(each);
  for (BuiltMarker& each : map->uncertain) moveOne(each);
  for (Pose& pose : map->trajectory) pose = other_from_map * pose;
}

}  // namespace

void align(const AlignmentRequest& request, const Drive& drive, BuiltMap* map) {
  if (request.isNone()) return;
  MapAlignment alignment;
  if (!request.points.empty()) {
    std::vector<PointPair> points;
    for (const AlignPoint& point : request.points) {
      points.push_back({markerOf(point, *map).marker.center().head<2>(), point.place});
    }
    alignment = alignByPoints(points);
  } else {
    alignment = alignByPoses(drive.posesIn(request.frame, map->stamps, map->trajectory));
  }
  transform(alignment.other_from_map, map);
  map->remarks.push_back(format(
      "the map was put into '%s' by %zu of %zu %s, which differ by %.3f m (RMS): standard "
      "deviation "
      "of the fit %.4f m and %.3f degrees",
      request.frame.empty() ? "map" : request.frame.c_str(), alignment.agreeing, alignment.all,
      request.points.empty() ? "poses" : "points", alignment.position_residual,
      alignment.positionDeviation(), degrees(alignment.headingDeviation())));
}

void printMap(const BuiltMap& map) {
  std::printf("%6s  %-20s %24s %10s %10s %6s %9s\n", "id", "name", "position (m)", "dev (mm)",
              "dev (deg)", "read", "rms (px)");
  for (const BuiltMarker& each : map.markers) {
    const Eigen::Vector3d center = each.marker.center();
    const std::string place = format("%.3f %.3f %.3f", center.x(), center.y(), center.z());
    const std::string name = each.is_seed && each.marker.name.empty() ? "(seed)" : each.marker.name;
    std::printf("%6d  %-20s %24s", each.marker.id, name.c_str(), place.c_str());
    if (each.isFound()) {
      std::printf(" %10.2f %10.3f", 1e3 * each.positionDeviation(),
                  degrees(each.orientationDeviation()));
    } else {
      std::printf(" %10s %10s", "-", "-");
    }
    std::printf(" %6zu %9.3f\n", each.sightings, each.residual);
    if (each.size_variance > 0.0) {
      std::printf("%8s size %.4f m, standard deviation %.2f mm\n", "", each.marker.size,
                  1e3 * std::sqrt(each.size_variance));
    }
  }
  if (!map.worst.empty()) std::printf("\nworst residuals:\n");
  for (const WorstReading& each : map.worst) {
    std::printf("  %8.2f px  %s at %.2f s\n", each.residual, each.marker.c_str(), each.stamp);
  }
  if (!map.remarks.empty()) std::printf("\n");
  for (const std::string& remark : map.remarks) std::printf("note: %s\n", remark.c_str());
  const std::vector<std::string> advice = adviceOn(map);
  if (!advice.empty()) std::printf("\n");
  for (const std::string& line : advice) std::printf("next: %s\n", line.c_str());
}

std::string mapText(const std::string& seed_path, const std::string& frame, const BuiltMap& map,
                    const std::string& path) {
  std::vector<MapEntry> all;
  std::vector<MapEntry> added;
  std::vector<EntryChange> changes;
  for (const BuiltMarker& each : map.markers) {
    const MapEntry entry =
        each.isFound() ? mappedEntry(each.marker, each.covariance) : MapEntry{each.marker, ""};
    all.push_back(entry);
    if (!each.is_seed) {
      added.push_back(entry);
    } else {
      changes.push_back({false, each.isFound() ? std::optional(entry.marker) : std::nullopt});
    }
  }
  if (seed_path.empty()) return newMapText(frame, all, path);
  const std::string text = readTextFile(seed_path);
  if (parseMarkerMap(text, seed_path).frame_id != frame) return newMapText(frame, all, path);
  const bool is_changed = std::any_of(changes.begin(), changes.end(),
                                      [](const EntryChange& change) { return change.moved; });
  return movedMapText(is_changed ? withChanges(text, changes, added, seed_path)
                                 : withEntries(text, added, seed_path),
                      seed_path, path);
}

}  // namespace omnitag
