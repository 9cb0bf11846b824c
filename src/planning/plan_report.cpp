#include "planning/plan_report.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/format.h"
#include "common/quantile.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

constexpr double kHigh = 0.95;

/// The place without a marker that is farthest from all places with one; any, if none has one.
std::optional<PlacePrediction> deepestWithout(const FloorPrediction& floor) {
  std::optional<PlacePrediction> deepest;
  double longest = 0.0;
  for (const PlacePrediction& place : floor.places) {
    if (place.markers > 0) continue;
    double nearest = std::numeric_limits<double>::infinity();
    for (const PlacePrediction& other : floor.places) {
      if (other.markers > 0) nearest = std::min(nearest, (other.place - place.place).norm());
    }
    if (nearest <= longest) continue;
    longest = nearest;
    deepest = place;
  }
  return deepest;
}

std::optional<PlacePrediction> leastCertain(const FloorPrediction& floor) {
  const auto worst = std::max_element(floor.places.begin(), floor.places.end(),
                                      [](const PlacePrediction& a, const PlacePrediction& b) {
                                        return a.position_deviation.value_or(0.0) <
                                               b.position_deviation.value_or(0.0);
                                      });
  return worst == floor.places.end() ? std::nullopt : std::optional(*worst);
}

std::string worstText(const FloorSummary& summary) {
  if (!summary.worst) return "-";
  const PlacePrediction& worst = *summary.worst;
  const std::string place = format("(%.1f, %.1f): ", worst.place.x(), worst.place.y());
  return place + (worst.position_deviation ? lengthText(*worst.position_deviation) : "no marker");
}

std::string row(const std::string& name, const std::vector<std::string>& cells) {
  std::string text = format("%-40s", name.c_str());
  for (const std::string& cell : cells) text += format(" %24s", cell.c_str());
  return text + "\n";
}

}  // namespace

std::string lengthText(double metres) {
  const auto text = [](double value, const char* unit) {
    const int below_ten = value < 1.0 ? 2 : 1;
    const int digits = value < 10.0 ? below_ten : 0;
    return format("%.*f %s", digits, value, unit);
  };
  if (metres < 0.9995e-2) return text(1e3 * metres, "mm");
  return metres < 0.995 ? text(1e2 * metres, "cm") : text(metres, "m");
}

FloorSummary summaryOf(const FloorPrediction& floor) {
  FloorSummary summary;
  if (floor.places.empty()) return summary;
  std::vector<double> positions;
  std::vector<double> headings;
  for (const PlacePrediction& place : floor.places) {
    const auto count = static_cast<std::size_t>(std::clamp(place.markers, 0, 3));
    summary.by_markers.at(count) += 1.0 / static_cast<double>(floor.places.size());
    if (!place.position_deviation) continue;
    positions.push_back(*place.position_deviation);
    headings.push_back(*place.heading_deviation);
  }
  summary.median_position = quantile(positions, 0.5);
  summary.high_position = quantile(positions, kHigh);
  summary.median_heading = quantile(headings, 0.5);
  summary.high_heading = quantile(headings, kHigh);
  summary.worst = deepestWithout(floor);
  if (!summary.worst) summary.worst = leastCertain(floor);
  return summary;
}

std::string summaryText(const std::vector<std::string>& titles,
                        const std::vector<FloorSummary>& summaries) {
  const auto rowOf = [&](const std::string& name, const auto& cellOf) {
    std::vector<std::string> cells;
    cells.reserve(summaries.size());
    for (const FloorSummary& summary : summaries) cells.push_back(cellOf(summary));
    return row(name, cells);
  };
  const auto share = [&](std::size_t count) {
    return
        [count](const FloorSummary& s) { return format("%.1f %%", 1e2 * s.by_markers.at(count)); };
  };
  const auto length = [](double FloorSummary::*value) {
    return [value](const FloorSummary& s) { return lengthText(s.*value); };
  };
  const auto angle = [](double FloorSummary::*value) {
    return [value](const FloorSummary& s) { return format("%.3f deg", degrees(s.*value)); };
  };
  return row("", titles) + rowOf("floor with three markers or more", share(3)) +
         rowOf("          two", share(2)) + rowOf("          one", share(1)) +
         rowOf("          none", share(0)) +
         rowOf("position deviation: median", length(&FloorSummary::median_position)) +
         rowOf("                    95th percentile", length(&FloorSummary::high_position)) +
         rowOf("heading deviation:  median", angle(&FloorSummary::median_heading)) +
         rowOf("                    95th percentile", angle(&FloorSummary::high_heading)) +
         rowOf("worst place (x, y)", worstText);
}

std::string csvText(const FloorPrediction& floor) {
  std::string text = "x,y,markers,position_deviation,heading_deviation\n";
  for (const PlacePrediction& place : floor.places) {
    text += format("%.3f,%.3f,%d,", place.place.x(), place.place.y(), place.markers);
    text += place.position_deviation
                ? format("%.6f,%.6f\n", *place.position_deviation, *place.heading_deviation)
                : ",\n";
  }
  return text;
}

std::string reachText(const std::vector<FamilyReach>& reaches) {
  std::string text = format("%-20s %8s %8s   %-24s   %s\n", "", "", "printed",
                            "recognized if predicted", "read in a search");
  text += format("%-20s %8s %8s   %10s %12s   %10s %12s\n", "family", "modules", "width",
                 "px/module", "up to", "px/module", "up to");
  for (const FamilyReach& reach : reaches) {
    text += format("%-20s %8d %6.2f m   %10.1f %10.1f m   %10.1f %10.1f m\n", reach.family.c_str(),
                   reach.modules, reach.printed_width, reach.smallest.recognized, reach.recognized,
                   reach.smallest.read, reach.read);
  }
  return text;
}

std::string reachCsv(const std::vector<FamilyReach>& reaches) {
  std::string text =
      "family,modules,printed_width,recognized_module,recognized_distance,read_module,"
      "read_distance\n";
  for (const FamilyReach& reach : reaches) {
    text += format("%s,%d,%.3f,%.2f,%.2f,%.2f,%.2f\n", reach.family.c_str(), reach.modules,
                   reach.printed_width, reach.smallest.recognized, reach.recognized,
                   reach.smallest.read, reach.read);
  }
  return text;
}

}  // namespace omnitag
