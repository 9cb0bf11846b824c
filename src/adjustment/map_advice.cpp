#include "adjustment/map_advice.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "adjustment/wall_groups.h"
#include "common/format.h"
#include "omnitag/common/angle.h"
#include "planning/plan_report.h"

namespace omnitag {
namespace {

constexpr double kTape = 0.005;  // m

enum class Need { kPast, kLonger, kNearer };

Need needOf(const BuiltMarker& marker) {
  const double kFewDirections = radians(30.0);
  constexpr std::size_t kFewImages = 10;
  if (marker.seen.parallax < kFewDirections) return Need::kPast;
  return marker.sightings < kFewImages ? Need::kLonger : Need::kNearer;
}

/// "markers 3, 7 (door) and 12 on the wall at x = 9.2 m".
std::string namesOf(const std::vector<Marker>& markers) {
  std::string text = markers.size() == 1 ? "marker " : "markers ";
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (i > 0) text += i + 1 == markers.size() ? " and " : ", ";
    text += std::to_string(markers[i].id);
    if (!markers[i].name.empty()) text += " (" + markers[i].name + ")";
  }
  return text + " " + placeOf(markers);
}

/// What to do about markers of one wall with the same need.
std::string lineOf(Need need, const std::vector<BuiltMarker>& group) {
  std::vector<Marker> markers;
  double deviation = 0.0;
  double nearest = group.front().seen.nearest;
  double parallax = 0.0;
  std::size_t images = 0;
  for (const BuiltMarker& each : group) {
    markers.push_back(each.marker);
    deviation = std::max(deviation, each.positionDeviation());
    nearest = std::min(nearest, each.seen.nearest);
    parallax = std::max(parallax, each.seen.parallax);
    images = std::max(images, each.sightings);
  }
  const std::string names = namesOf(markers);
  std::string text;
  switch (need) {
    case Need::kPast:
      text = "drive past " + names +
             format(", seen from directions up to %.0f degrees apart", degrees(parallax));
      break;
    case Need::kLonger:
      text = "keep " + names + format(" in sight for longer, read in up to %zu images", images);
      break;
    case Need::kNearer:
      text = "drive nearer to " + names + ", seen from " + lengthText(nearest) + " at the nearest";
      break;
  }
  return text + (group.size() == 1 ? ": it is known to " : ": they are known to ") +
         lengthText(deviation);
}

void addLines(Need need, const std::vector<BuiltMarker>& poor, std::vector<std::string>* lines) {
  std::vector<BuiltMarker> needy;
  std::vector<Marker> markers;
  for (const BuiltMarker& each : poor) {
    if (needOf(each) != need) continue;
    needy.push_back(each);
    markers.push_back(each.marker);
  }
  for (const std::vector<std::size_t>& indices : groupedByWall(markers)) {
    std::vector<BuiltMarker> group;
    group.reserve(indices.size());
    for (const std::size_t index : indices) group.push_back(needy[index]);
    lines->push_back(lineOf(need, group));
  }
}

/// `deviation`: m, of the worst of them.
std::string lineOfGood(std::size_t count, double deviation, bool are_all) {
  const std::string subject =
      count == 1 ? std::string(are_all ? "the" : "the other") + " marker"
                 : format(are_all ? "all %zu markers" : "the %zu other markers", count);
  return (are_all ? "nothing to do; " : "") + subject +
         (count == 1 ? " that was found is known to " : " that were found are known to ") +
         lengthText(deviation) + (count == 1 ? "" : " or better");
}

}  // namespace

std::vector<std::string> adviceOn(const BuiltMap& map) {
  std::vector<BuiltMarker> poor;
  std::size_t good = 0;
  double worst_good = 0.0;
  for (const BuiltMarker& each : map.markers) {
    if (!each.isFound()) continue;
    if (each.positionDeviation() > kTape) {
      poor.push_back(each);
    } else {
      ++good;
      worst_good = std::max(worst_good, each.positionDeviation());
    }
  }
  poor.insert(poor.end(), map.uncertain.begin(), map.uncertain.end());
  std::vector<std::string> lines;
  for (const Need need : {Need::kNearer, Need::kPast, Need::kLonger}) {
    addLines(need, poor, &lines);
  }
  if (good > 0) lines.push_back(lineOfGood(good, worst_good, poor.empty()));
  return lines;
}

}  // namespace omnitag
