#include "planning/marker_placement.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "common/format.h"
#include "common/parallel.h"
#include "marker/tag_family.h"
#include "omnitag/common/angle.h"
#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"
#include "planning/expected_information.h"
#include "planning/greedy_choice.h"
#include "planning/pose_prediction.h"
#include "planning/sight.h"
#include "planning/wall_places.h"

namespace omnitag {
namespace {

/// A marker with its white border, as a multiple of its size, and some room to glue it.
constexpr double kBoard = 1.4;

/// Ids of the family that no marker of the map has.
std::vector<int> unusedIds(const MarkerMap& map, const NewMarkers& wanted) {
  std::set<int> used;
  for (const Marker& marker : map.markers) {
    if (marker.family == wanted.family) used.insert(marker.id);
  }
  const auto count = static_cast<std::size_t>(wanted.count);
  std::vector<int> ids;
  for (int id = 0; id < tagCount(wanted.family) && ids.size() < count; ++id) {
    if (used.count(id) == 0) ids.push_back(id);
  }
  if (ids.size() < count) {
    throw InputError(format("%s has %d ids that the map does not use, expected at least %d",
                            wanted.family.c_str(), static_cast<int>(ids.size()), wanted.count));
  }
  return ids;
}

/// Rounds places and headings to what somebody can measure.
double rounded(double value, double step) { return step * std::round(value / step); }

Marker markerAt(const WallPlace& place, const NewMarkers& wanted, int id) {
  constexpr double kCentimetre = 0.01;
  Marker marker;
  marker.family = wanted.family;
  marker.id = id;
  marker.size = wanted.size;
  marker.deviation = kSurveyedDeviation;
  marker.orientation_deviation = kSurveyedOrientationDeviation;
  marker.map_from_marker =
      Eigen::Translation3d(rounded(place.position.x(), kCentimetre),
                           rounded(place.position.y(), kCentimetre), wanted.height) *
      uprightOrientation(rounded(place.yaw, radians(1.0)), 0.0);
  return marker;
}

bool coversOther(const Marker& marker, const MarkerMap& map) {
  return std::any_of(map.markers.begin(), map.markers.end(), [&](const Marker& other) {
    const bool is_same_side = marker.normal().dot(other.normal()) > 0.0;
    const double least = 0.5 * kBoard * (marker.size + other.size);
    return is_same_side && (marker.center() - other.center()).norm() < least;
  });
}

MarkerMap candidatesOn(const OccupancyGrid& grid, const MarkerMap& map, const NewMarkers& wanted,
                       int id) {
  constexpr double kSpacing = 0.4;  // m
  const double board = kBoard * wanted.size;
  MarkerMap candidates;
  for (const WallPlace& place : wallPlaces(grid, board, std::max(kSpacing, board))) {
    const Marker marker = markerAt(place, wanted, id);
    if (!coversOther(marker, map)) candidates.markers.push_back(marker);
  }
  if (candidates.markers.empty()) {
    throw InputError(
        format("expected a free and flat piece of wall at least %.2f m wide, found none", board));
  }
  return candidates;
}

}  // namespace

MarkerPlacement placeMarkers(const PlanningScene& scene, const MarkerMap& map,
                             const std::vector<Pose>& poses, const NewMarkers& wanted,
                             int threads) {
  constexpr std::size_t kWorthAThread = 10;
  const std::vector<int> ids = unusedIds(map, wanted);
  const MarkerMap candidates = candidatesOn(scene.grid, map, wanted, ids.front());
  // The patterns of a family hardly differ in this.
  const PatternEdges edges = edgesOf(candidates.markers.front());
  const PosePredictor predictor(scene, map);
  InformationProblem problem;
  problem.known.resize(poses.size());
  forEachIndex(poses.size(), threads, kWorthAThread, [&](std::size_t i) {
    problem.known[i] = withPriors(predictor.predict(poses[i]).equations, scene.priorAt(poses[i]),
                                  poses[i], ImagingError::Zero())
                           .information;
  });
  problem.candidates = candidates.markers.size();
  problem.addedBy = [&](std::size_t candidate) {
    std::vector<AddedInformation> added;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (!isRecognized(scene, candidates, candidate, edges, poses[i])) continue;
      const auto equations =
          expectedEquations(scene, candidates.markers[candidate], edges, poses[i]);
      if (equations) added.push_back({i, equations->information});
    }
    return added;
  };
  const GreedyChoice choice =
      chooseGreedily(problem, static_cast<std::size_t>(wanted.count), threads);
  MarkerPlacement placement;
  placement.guaranteed_share = choice.guaranteed_share;
  placement.candidates = candidates.markers.size();
  for (std::size_t i = 0; i < choice.candidates.size(); ++i) {
    placement.markers.push_back(candidates.markers[choice.candidates[i]]);
    placement.markers.back().id = ids[i];
  }
  return placement;
}

}  // namespace omnitag
