#include "adjustment/recording.h"

#include <algorithm>
#include <map>
#include <utility>

namespace omnitag {

std::string nameOf(const Marker& marker) {
  std::string name = "marker " + std::to_string(marker.id);
  if (!marker.name.empty()) name += " (" + marker.name + ")";
  return name;
}

Recording::Recording(std::shared_ptr<const CameraModel> camera_model,
                     const std::vector<FrameReadings>& inputs, const MarkerMap& seed, double size)
    : camera(std::move(camera_model)) {
  std::map<std::pair<std::string, int>, std::vector<std::size_t>> known;
  for (const Marker& marker : seed.markers) {
    known[{marker.family, marker.id}].push_back(markers.size());
    markers.push_back({marker, true, true, PlacePrior::surveyed(marker)});
  }
  std::map<std::pair<std::string, int>, std::size_t> unknown;
  for (const FrameReadings& input : inputs) {
    for (const MarkerReading& reading : input.readings) {
      if (known.count({reading.family, reading.id}) == 0) unknown[{reading.family, reading.id}] = 0;
    }
  }
  for (auto& [key, index] : unknown) {
    index = markers.size();
    Marker marker;
    marker.family = key.first;
    marker.id = key.second;
    marker.size = size;
    markers.push_back({marker, false, false, std::nullopt});
  }
  for (const FrameReadings& input : inputs) {
    RecordedFrame frame{input, MountedCamera(camera, input.base_from_camera), {}, std::nullopt, {}};
    for (const MarkerReading& reading : input.readings) {
      const auto found = unknown.find({reading.family, reading.id});
      frame.markers.push_back(found == unknown.end() ? std::nullopt : std::optional(found->second));
    }
    frames.push_back(std::move(frame));
  }
}

std::vector<ReadingIndex> Recording::readingsOf(std::size_t marker, bool with_pose_only) const {
  std::vector<ReadingIndex> places;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (with_pose_only && !frames[f].map_from_base) continue;
    for (std::size_t r = 0; r < frames[f].markers.size(); ++r) {
      if (frames[f].markers[r] == marker) places.push_back({f, r});
    }
  }
  return places;
}

MarkerSighting Recording::sighting(const ReadingIndex& place) const {
  const RecordedFrame& frame = frames[place.frame];
  return {frame.input.stamp, frame.input.base_from_camera,
          frame.map_from_base.value_or(PoseEstimate{}),
          frame.input.readings[place.reading].corners};
}

std::vector<MarkerSighting> Recording::sightings(const std::vector<ReadingIndex>& places) const {
  std::vector<MarkerSighting> result;
  result.reserve(places.size());
  for (const ReadingIndex& place : places) result.push_back(sighting(place));
  return result;
}

MarkerMap Recording::placedMap(std::vector<std::size_t>* indices) const {
  MarkerMap map;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    if (!markers[i].is_placed) continue;
    map.markers.push_back(markers[i].marker);
    indices->push_back(i);
  }
  return map;
}

std::size_t Recording::framesWithPose() const {
  return static_cast<std::size_t>(
      std::count_if(frames.begin(), frames.end(),
                    [](const RecordedFrame& frame) { return frame.map_from_base.has_value(); }));
}

}  // namespace omnitag
