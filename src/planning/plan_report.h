#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "planning/family_limits.h"
#include "planning/floor_prediction.h"

namespace omnitag {

/// A floor in numbers.
struct FloorSummary {
  /// Shares of the places at which no marker is recognized, one, two, and three or more.
  std::array<double, 4> by_markers{};
  /// m, and rad: median and 95th percentile over the places at which there is a marker.
  double median_position = 0.0;
  double high_position = 0.0;
  double median_heading = 0.0;
  double high_heading = 0.0;
  /// The place without a marker that is farthest from those with one; without any such, the one
  /// with the largest position deviation. Nothing if there are no places.
  std::optional<PlacePrediction> worst;
};

FloorSummary summaryOf(const FloorPrediction& floor);

/// A length in words: millimetres, centimetres or metres, with two digits.
std::string lengthText(double metres);

/// A table of one column for each floor, under its title.
std::string summaryText(const std::vector<std::string>& titles,
                        const std::vector<FloorSummary>& summaries);

/// With the header line x,y,markers,position_deviation,heading_deviation, in m and rad; deviations
/// are empty without a marker.
std::string csvText(const FloorPrediction& floor);

/// As a table for people and as a CSV file.
std::string reachText(const std::vector<FamilyReach>& reaches);
std::string reachCsv(const std::vector<FamilyReach>& reaches);

}  // namespace omnitag
