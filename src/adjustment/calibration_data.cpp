#include "adjustment/calibration_data.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr std::size_t kMinMarkers = 3;
constexpr std::size_t kMinFrames = 10;

/// Mean edge in pixels: the modules of smaller markers are hardly two pixels wide, and their
/// corners are several times less exact and displaced inwards.
constexpr double kLargeEdge = 16.0;

/// Counts of what the readings contain.
struct Census {
  std::set<std::size_t> entries;
  std::set<int> ambiguous_ids;
  std::size_t readings = 0;
  std::size_t unmapped = 0;
  std::size_t repeated = 0;
  std::size_t small = 0;
};

std::string count(std::size_t number, const std::string& what) {
  return std::to_string(number) + " " + what + (number == 1 ? "" : "s");
}

std::string join(const std::set<int>& ids) {
  std::string text;
  for (const int id : ids) text += (text.empty() ? "" : ", ") + std::to_string(id);
  return text;
}

CalibrationFrame select(const MarkerMap& map, const FrameReadings& frame, double min_edge,
                        Census* census) {
  std::map<std::size_t, std::vector<const MarkerReading*>> by_entry;
  for (const MarkerReading& reading : frame.readings) {
    ++census->readings;
    const std::vector<std::size_t> entries = entriesOf(map, reading.family, reading.id);
    if (entries.empty()) {
      ++census->unmapped;
    } else if (meanEdge(reading.corners) < min_edge) {
      ++census->small;
    } else if (entries.size() > 1) {
      census->ambiguous_ids.insert(reading.id);
    } else {
      by_entry[entries.front()].push_back(&reading);
    }
  }
  CalibrationFrame selected;
  selected.stamp = frame.stamp;
  for (const auto& [entry, readings] : by_entry) {
    if (readings.size() > 1) {
      census->repeated += readings.size();
      continue;
    }
    census->entries.insert(entry);
    selected.observations.push_back({entry, readings.front()->corners, readings.front()->center});
  }
  return selected;
}

[[noreturn]] void refuse(const Census& census, std::size_t usable, std::size_t frames) {
  const std::string in_frames = " in " + count(frames, "image");
  if (census.readings == 0) {
    throw InputError("no marker was read" + in_frames +
                     ": see with localize_bag's debug image whether markers are large enough, and "
                     "whether the guess has the image's circle in its place");
  }
  if (!census.ambiguous_ids.empty() && census.entries.size() < kMinMarkers) {
    throw InputError("the map has several markers with id " + join(census.ambiguous_ids) +
                     ": a calibration cannot tell them apart; expected at least " +
                     std::to_string(kMinMarkers) +
                     " markers whose ids stand in the map once: hang some of their own ids");
  }
  if (census.repeated > 0 && census.entries.size() < kMinMarkers) {
    throw InputError(
        "markers were read in two places of the same image: the same id hangs twice; cover one of "
        "each pair, or hang other ids");
  }
  if (census.entries.empty()) {
    throw InputError("none of the " + count(census.readings, "marker") + " that were read" +
                     in_frames + " is in the map: is this its map?");
  }
  if (census.entries.size() < kMinMarkers) {
    throw InputError("only " + count(census.entries.size(), "marker") + " of the map " +
                     (census.entries.size() == 1 ? "was" : "were") + " read" + in_frames +
                     ", expected at least " + std::to_string(kMinMarkers) +
                     ", all around the robot: hang and map more, or drive where more are in sight");
  }
  throw InputError(count(usable, "image") + " of " + std::to_string(frames) + " show " +
                   std::to_string(kMinMarkers) + " mapped markers or more, expected at least " +
                   std::to_string(kMinFrames) +
                   " such images: drive longer, where several markers are in sight at once");
}

}  // namespace

CalibrationData selectObservations(const MarkerMap& map, const std::vector<FrameReadings>& frames,
                                   bool prefers_large) {
  CalibrationData data;
  Census census;
  for (const double min_edge : {prefers_large ? kLargeEdge : 0.0, 0.0}) {
    data = {};
    census = {};
    for (const FrameReadings& frame : frames) {
      CalibrationFrame selected = select(map, frame, min_edge, &census);
      if (selected.observations.size() >= kMinMarkers) data.frames.push_back(std::move(selected));
    }
    if (data.frames.size() >= kMinFrames) break;
  }
  if (data.frames.size() < kMinFrames) refuse(census, data.frames.size(), frames.size());
  if (census.small > 0) {
    data.remarks.push_back("left out, as smaller than " + std::to_string(std::lround(kLargeEdge)) +
                           " px: " + count(census.small, "reading"));
  }
  if (!census.ambiguous_ids.empty()) {
    data.remarks.push_back("left out, as the map has them more than once: id " +
                           join(census.ambiguous_ids));
  }
  if (census.repeated > 0) {
    data.remarks.push_back("left out, as the same id was read twice in one image: " +
                           count(census.repeated, "reading"));
  }
  if (census.unmapped > 0) {
    data.remarks.push_back("left out, as the map does not have them: " +
                           count(census.unmapped, "reading"));
  }
  return data;
}

}  // namespace omnitag
