#include "adjustment/contradicted_markers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "adjustment/marker_places.h"
#include "common/format.h"

namespace omnitag {
namespace {

class ContradictionSearch {
 public:
  ContradictionSearch(const Recording& recording, const MapBuilderConfig& config)
      : recording_(recording), config_(config) {}

  ContradictedMarkers look() {
    for (std::size_t m = 0; m < recording_.markers.size(); ++m) {
      const std::vector<ReadingIndex> readings = readingsOfId(m);
      if (!isSuspect(m, readings)) continue;
      const RecordedMarker& marker = recording_.markers[m];
      // A marker of another size seems to hang elsewhere wherever it is seen from.
      if (const auto sized = sizeContradicting(m, readings)) {
        result_.remarks.push_back(describeSize(marker, *sized));
        if (!marker.is_seed) result_.left_out.push_back(m);
        continue;
      }
      const auto places = placesOf(recording_, m, readings, config_);
      if (places.size() < 2) continue;
      constexpr std::size_t kMoves = 3;
      if (changesBetween(places) > kMoves) {
        throw DegenerateRecording(format(
            "%s hangs at %zu places, %.2f m apart: take one down, or give the seed map an entry "
            "for each",
            nameOf(marker.marker).c_str(), places.size(),
            (places[1].marker.center() - places[0].marker.center()).norm()));
      }
      result_.remarks.push_back(describeMove(recording_, places) +
                                (marker.is_seed ? ": its entry in the seed map is kept"
                                                : ": left out, record again while it stays"));
      if (!marker.is_seed) result_.left_out.push_back(m);
    }
    return std::move(result_);
  }

 private:
  /// Nothing if sizes are estimated anyway.
  std::optional<Marker> sizeContradicting(std::size_t index,
                                          const std::vector<ReadingIndex>& readings) const {
    if (config_.estimates_sizes && !recording_.markers[index].is_seed) return std::nullopt;
    return atAnotherSize(recording_, index, readings, config_);
  }

  static std::string describeSize(const RecordedMarker& marker, const Marker& sized) {
    const std::string sizes =
        format("its readings tell a size of %.3f m, not %.3f m: ", sized.size, marker.marker.size);
    if (marker.is_seed)
      return nameOf(marker.marker) + ": " + sizes + "correct its size in the seed map";
    return nameOf(marker.marker) + " left out: " + sizes +
           "have sizes estimated (--estimate-sizes)";
  }

  /// Including readings with a seed's id that hang elsewhere than the seed says.
  std::vector<ReadingIndex> readingsOfId(std::size_t index) const {
    const Marker& marker = recording_.markers[index].marker;
    const auto twins = std::count_if(
        recording_.markers.begin(), recording_.markers.end(), [&](const RecordedMarker& other) {
          return other.marker.id == marker.id && other.marker.family == marker.family;
        });
    if (twins > 1) return recording_.readingsOf(index);
    std::vector<ReadingIndex> places;
    for (std::size_t f = 0; f < recording_.frames.size(); ++f) {
      const RecordedFrame& frame = recording_.frames[f];
      if (!frame.map_from_base) continue;
      for (std::size_t r = 0; r < frame.input.readings.size(); ++r) {
        const MarkerReading& reading = frame.input.readings[r];
        if (reading.id == marker.id && reading.family == marker.family) places.push_back({f, r});
      }
    }
    return places;
  }

  bool isSuspect(std::size_t index, const std::vector<ReadingIndex>& readings) const {
    const RecordedMarker& marker = recording_.markers[index];
    const auto few = static_cast<std::size_t>(config_.min_sightings);
    if (readings.size() < few) return false;
    if (!marker.is_placed) return true;
    std::size_t off = 0;
    for (const ReadingIndex& place : readings)
      off += residualOf(recording_, place, marker.marker) > config_.max_residual ? 1 : 0;
    return off >= few;
  }

  const Recording& recording_;
  const MapBuilderConfig& config_;
  ContradictedMarkers result_;
};

}  // namespace

ContradictedMarkers contradictedMarkers(const Recording& recording,
                                        const MapBuilderConfig& config) {
  return ContradictionSearch(recording, config).look();
}

double residualOf(const Recording& recording, const ReadingIndex& place, const Marker& marker) {
  const RecordedFrame& frame = recording.frames[place.frame];
  const auto projection = projectMarker(marker, frame.camera, frame.map_from_base->pose);
  if (!projection) return std::numeric_limits<double>::infinity();
  const CornerPixels off =
      projection->pixels - stacked(frame.input.readings[place.reading].corners);
  return std::sqrt(off.squaredNorm() / 4.0);
}

}  // namespace omnitag
