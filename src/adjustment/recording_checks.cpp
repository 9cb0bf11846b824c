#include "adjustment/recording_checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "common/format.h"

namespace omnitag {
namespace {

[[noreturn]] void refuse(const char* text) { throw DegenerateRecording(text); }

template <typename Value, typename... Values>
[[noreturn]] void refuse(const char* pattern, Value value, Values... values) {
  refuse(format(pattern, value, values...).c_str());
}

using Key = std::pair<std::string, int>;

/// Throws if more than one image shows an id at more places than it has entries: a single reading
/// may be wrong.
void checkRepeatedIds(const Recording& recording) {
  std::map<Key, std::size_t> entries;
  for (const RecordedMarker& marker : recording.markers) {
    ++entries[{marker.marker.family, marker.marker.id}];
  }
  std::map<Key, int> images_with_repetition;
  for (const RecordedFrame& frame : recording.frames) {
    std::map<Key, std::size_t> counts;
    for (const MarkerReading& reading : frame.input.readings) {
      ++counts[{reading.family, reading.id}];
    }
    for (const auto& [key, count] : counts) {
      if (count <= entries[key]) continue;
      constexpr int kMisreadings = 1;
      if (++images_with_repetition[key] <= kMisreadings) continue;
      refuse(
          "marker %d hangs at %zu places at once, as in the image at %.2f s: take one down, or "
          "give the seed map an entry for each",
          key.second, count, frame.input.stamp);
    }
  }
}

/// The smallest sector around the robot that holds all bearings, in rad.
double sectorOf(std::vector<double> bearings) {
  if (bearings.size() < 2) return 0.0;
  std::sort(bearings.begin(), bearings.end());
  double gap = bearings.front() + 2.0 * kPi - bearings.back();
  for (std::size_t i = 1; i < bearings.size(); ++i) {
    gap = std::max(gap, bearings[i] - bearings[i - 1]);
  }
  return 2.0 * kPi - gap;
}

double middleSector(const Recording& recording) {
  std::vector<double> sectors;
  for (const RecordedFrame& frame : recording.frames) {
    if (!frame.map_from_base) continue;
    std::vector<double> bearings;
    for (const MarkerReading& reading : frame.input.readings) {
      const auto ray = frame.camera.rayInBase(reading.center);
      if (ray) bearings.push_back(std::atan2(ray->direction.y(), ray->direction.x()));
    }
    sectors.push_back(sectorOf(std::move(bearings)));
  }
  const auto middle = sectors.begin() + static_cast<std::ptrdiff_t>(sectors.size() / 2);
  std::nth_element(sectors.begin(), middle, sectors.end());
  return *middle;
}

double motionOf(const Recording& recording) {
  double largest = 0.0;
  for (const RecordedFrame& a : recording.frames) {
    for (const RecordedFrame& b : recording.frames) {
      if (!a.map_from_base || !b.map_from_base) continue;
      largest = std::max(largest,
                         difference(a.map_from_base->pose, b.map_from_base->pose).head<2>().norm());
    }
  }
  return largest;
}

}  // namespace

void checkReadings(const Recording& recording) {
  std::set<Key> seen;
  std::size_t seen_of_seed = 0;
  std::size_t new_markers = 0;
  for (const RecordedFrame& frame : recording.frames) {
    for (const MarkerReading& reading : frame.input.readings) {
      seen.insert({reading.family, reading.id});
    }
  }
  std::size_t seeds = 0;
  for (const RecordedMarker& marker : recording.markers) {
    seeds += marker.is_seed ? 1 : 0;
    new_markers += marker.prior && marker.prior->isExact() ? 0 : 1;
    seen_of_seed += marker.is_seed ? seen.count({marker.marker.family, marker.marker.id}) : 0;
  }
  if (seen.empty()) {
    refuse(
        "no marker was read in any of %zu images: check the family, and that modules are at least "
        "two pixels wide",
        recording.frames.size());
  }
  if (seeds > 0 && seen_of_seed == 0) {
    refuse(
        "none of the seed's %zu markers was read in any of %zu images: record where they are in "
        "sight",
        seeds, recording.frames.size());
  }
  if (seeds > 0 && new_markers == 0) {
    refuse("all markers that were read are in the seed map: there is nothing to add");
  }
  if (seen.size() == 1) {
    refuse("only marker %d was read: a map needs at least two, better four all around",
           seen.begin()->second);
  }
  checkRepeatedIds(recording);
}

void checkPoses(const Recording& recording, const MapBuilderConfig& config) {
  const std::size_t count = recording.framesWithPose();
  if (count < 2) {
    refuse(
        "%zu of %zu images tell where the robot was: start where two known markers or more are in "
        "sight, and see that markers come into sight before others are lost",
        count, recording.frames.size());
  }
  const double motion = motionOf(recording);
  if (motion < config.min_motion) {
    refuse(
        "too little motion: the robot's places are within %.2f m of each other; drive at least "
        "%.2f m, past the markers rather than toward them",
        motion, config.min_motion);
  }
  const double sector = middleSector(recording);
  if (sector < config.min_sector) {
    refuse(
        "markers on one side only: in most images all are within %.0f degrees; hang some on other "
        "sides of the way, %.0f degrees apart at least",
        degrees(sector), degrees(config.min_sector));
  }
}

}  // namespace omnitag
