#include "planning/floor_prediction.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/grid_index.h"
#include "common/parallel.h"
#include "omnitag/common/angle.h"
#include "planning/expected_information.h"
#include "planning/pose_prediction.h"

namespace omnitag {
namespace {

/// A heading's part in the summary of a place.
struct Part {
  int markers = 0;
  double position = 0.0;
  double heading = 0.0;
};

PlacePrediction summaryOf(const Eigen::Vector2d& place, std::vector<Part> parts,
                          Headings headings) {
  PlacePrediction summary;
  summary.place = place;
  std::sort(parts.begin(), parts.end(),
            [](const Part& a, const Part& b) { return a.markers < b.markers; });
  const bool is_worst = headings == Headings::kWorst;
  summary.markers = parts[is_worst ? 0 : parts.size() / 2].markers;
  if (summary.markers == 0) return summary;
  const auto sumUp = [&](double Part::*deviation) {
    double squares = 0.0;
    double largest = 0.0;
    int count = 0;
    for (const Part& part : parts) {
      if (part.markers == 0) continue;
      squares += part.*deviation * part.*deviation;
      largest = std::max(largest, part.*deviation);
      ++count;
    }
    return is_worst ? largest : std::sqrt(squares / count);
  };
  summary.position_deviation = sumUp(&Part::position);
  summary.heading_deviation = sumUp(&Part::heading);
  return summary;
}

}  // namespace

FloorPrediction placesOn(const OccupancyGrid& grid, double step, double clearance) {
  constexpr double kPlaces = 3000.0;
  const std::vector<double> clearances = grid.clearances();
  const auto isPlace = [&](double there) { return there > 0.0 && there >= clearance; };
  if (step <= 0.0) {
    const auto cells =
        static_cast<double>(std::count_if(clearances.begin(), clearances.end(), isPlace));
    step = std::sqrt(cells / kPlaces) * grid.resolution();
  }
  const int stride = std::max(1, static_cast<int>(std::lround(step / grid.resolution())));
  FloorPrediction floor;
  floor.step = stride * grid.resolution();
  for (int row = stride / 2; row < grid.rows(); row += stride) {
    for (int column = stride / 2; column < grid.columns(); column += stride) {
      if (!isPlace(clearances[gridIndex(column, row, grid.columns())])) continue;
      PlacePrediction place;
      place.place = grid.middleOf(column, row);
      floor.places.push_back(place);
    }
  }
  return floor;
}

std::vector<Pose> posesAt(const std::vector<PlacePrediction>& places, int count) {
  std::vector<Pose> poses;
  for (const PlacePrediction& place : places) {
    for (int i = 0; i < count; ++i) {
      poses.push_back({place.place.x(), place.place.y(), normalizeAngle(2.0 * kPi * i / count)});
    }
  }
  return poses;
}

FloorPrediction predictFloor(const PlanningScene& scene, const MarkerMap& map,
                             const FloorPrediction& floor, int headings, Headings summary,
                             int threads) {
  constexpr std::size_t kWorthAThread = 5;
  const PosePredictor predictor(scene, map);
  FloorPrediction predicted = floor;
  forEachIndex(floor.places.size(), threads, kWorthAThread, [&](std::size_t i) {
    std::vector<Part> parts;
    for (const Pose& pose : posesAt({floor.places[i]}, headings)) {
      const PosePrediction prediction = predictor.predict(pose);
      const PoseEstimate estimate = expectedEstimate(scene, prediction.equations, pose);
      parts.push_back({static_cast<int>(prediction.markers.size()), positionDeviation(estimate),
                       std::sqrt(estimate.covariance(2, 2))});
    }
    predicted.places[i] = summaryOf(floor.places[i].place, std::move(parts), summary);
  });
  return predicted;
}

}  // namespace omnitag
