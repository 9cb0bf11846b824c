#include "adjustment/marker_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

namespace omnitag {
namespace {

/// Least number of readings at a place.
constexpr std::size_t kFew = 3;

std::vector<ReadingIndex> agreeing(const Recording& recording, const Marker& marker,
                                   const std::vector<ReadingIndex>& readings, double max_residual) {
  std::vector<ReadingIndex> result;
  for (const ReadingIndex& place : readings) {
    const RecordedFrame& frame = recording.frames[place.frame];
    const auto projection = projectMarker(marker, frame.camera, frame.map_from_base->pose);
    const CornerPixels pixels = stacked(frame.input.readings[place.reading].corners);
    // RMS over the four corners.
    if (projection && (projection->pixels - pixels).norm() <= 2.0 * max_residual) {
      result.push_back(place);
    }
  }
  return result;
}

/// The place at which most readings agree, among places estimated from a few successive readings.
std::optional<MarkerPlace> mostAgreed(const Recording& recording, const Marker& marker,
                                      const std::vector<ReadingIndex>& readings,
                                      const MapBuilderConfig& config) {
  const MarkerEstimateConfig estimate_config{config.corner_noise, false};
  const auto placeOf = [&](const std::vector<ReadingIndex>& some) -> std::optional<MarkerPlace> {
    const auto estimate = estimateMarker(marker, {recording.camera}, recording.sightings(some),
                                         std::nullopt, estimate_config);
    if (!estimate) return std::nullopt;
    return MarkerPlace{estimate->marker,
                       agreeing(recording, estimate->marker, readings, config.max_residual)};
  };
  std::optional<MarkerPlace> best;
  for (std::size_t first = 0; first + kFew <= readings.size(); ++first) {
    const auto begin = readings.begin() + static_cast<std::ptrdiff_t>(first);
    auto place = placeOf({begin, begin + kFew});
    if (place && (!best || place->readings.size() > best->readings.size())) best = place;
  }
  // A few readings do not determine the place exactly enough to find all that agree.
  for (int round = 0; best && round < 2; ++round) {
    auto place = placeOf(best->readings);
    if (place && place->readings.size() >= best->readings.size()) best = std::move(place);
  }
  return best && best->readings.size() >= kFew ? best : std::nullopt;
}

bool isEarlier(const ReadingIndex& a, const ReadingIndex& b) { return a.frame < b.frame; }

}  // namespace

std::vector<MarkerPlace> placesOf(const Recording& recording, std::size_t marker,
                                  const std::vector<ReadingIndex>& readings,
                                  const MapBuilderConfig& config) {
  std::vector<MarkerPlace> places;
  std::vector<ReadingIndex> left = readings;
  while (left.size() >= kFew) {
    auto place = mostAgreed(recording, recording.markers[marker].marker, left, config);
    if (!place) break;
    const auto isTaken = [&](const ReadingIndex& reading) {
      return std::any_of(place->readings.begin(), place->readings.end(),
                         [&](const ReadingIndex& taken) {
                           return taken.frame == reading.frame && taken.reading == reading.reading;
                         });
    };
    left.erase(std::remove_if(left.begin(), left.end(), isTaken), left.end());
    places.push_back(std::move(*place));
  }
  std::sort(places.begin(), places.end(), [](const MarkerPlace& a, const MarkerPlace& b) {
    return isEarlier(a.readings.front(), b.readings.front());
  });
  return places;
}

std::optional<Marker> atAnotherSize(const Recording& recording, std::size_t marker,
                                    const std::vector<ReadingIndex>& readings,
                                    const MapBuilderConfig& config) {
  constexpr double kNearlyAll = 0.9;
  constexpr double kLeastDifference = 0.02;  // of the size: smaller ones move no corner by pixels
  constexpr double kSure = 4.0;              // standard deviations
  const Marker& taken = recording.markers[marker].marker;
  const auto sightings = recording.sightings(readings);
  const auto estimate = [&](bool estimates_size) {
    return estimateMarker(taken, {recording.camera}, sightings, std::nullopt,
                          MarkerEstimateConfig{config.corner_noise, estimates_size});
  };
  const auto agreesWithNearlyAll = [&](const MarkerEstimate& some) {
    const auto count = agreeing(recording, some.marker, readings, config.max_residual).size();
    return static_cast<double>(count) >= kNearlyAll * static_cast<double>(readings.size());
  };
  const auto sized = estimate(true);
  if (!sized || !agreesWithNearlyAll(*sized)) return std::nullopt;
  const double difference = std::abs(sized->marker.size - taken.size);
  if (difference < kLeastDifference * taken.size ||
      difference < kSure * std::sqrt(sized->size_variance)) {
    return std::nullopt;
  }
  const auto as_taken = estimate(false);
  if (as_taken && agreesWithNearlyAll(*as_taken)) return std::nullopt;
  return sized->marker;
}

std::size_t changesBetween(const std::vector<MarkerPlace>& places) {
  std::vector<std::pair<std::size_t, std::size_t>> frames;  // and their places
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (const ReadingIndex& reading : places[i].readings) frames.emplace_back(reading.frame, i);
  }
  std::sort(frames.begin(), frames.end());
  std::size_t changes = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    changes += frames[i].second != frames[i - 1].second ? 1 : 0;
  }
  return changes;
}

std::string describeMove(const Recording& recording, const std::vector<MarkerPlace>& places) {
  const auto stamp = [&](const ReadingIndex& reading) {
    return recording.frames[reading.frame].input.stamp;
  };
  std::string text = nameOf(places.front().marker);
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double distance = (places[i].marker.center() - places[i - 1].marker.center()).norm();
    std::array<char, 128> part{};
    std::snprintf(part.data(), part.size(), "%s moved by %.2f m between %.2f s and %.2f s",
                  i == 1 ? "" : " and", distance, stamp(places[i - 1].readings.back()),
                  stamp(places[i].readings.front()));
    text += part.data();
  }
  return text;
}

}  // namespace omnitag
