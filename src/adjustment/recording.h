#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adjustment/bundle.h"
#include "adjustment/corner_alignment.h"
#include "adjustment/map_builder.h"
#include "adjustment/marker_estimate.h"
#include "camera/mounted_camera.h"
#include "localization/frame_readings.h"
#include "omnitag/common/pose.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A marker that a recording shows or a seed has; referred to by index.
struct RecordedMarker {
  Marker marker;
  bool is_seed = false;
  /// Whether the place of `marker` is known.
  bool is_placed = false;
  /// Prior of its place.
  std::optional<PlacePrior> prior;
};

/// An image of a recording.
struct RecordedFrame {
  FrameReadings input;
  MountedCamera camera;
  /// For each reading, the index of its marker; none for a reading with a seed's id that hangs
  /// elsewhere, or while it is unknown which of several entries it belongs to.
  std::vector<std::optional<std::size_t>> markers;
  std::optional<PoseEstimate> map_from_base;
  /// For each reading, its corners located by all of the marker's pixels; empty until the map is
  /// known.
  std::vector<std::optional<AlignedCorners>> aligned;
};

/// A reading by its indices in the recording.
struct ReadingIndex {
  std::size_t frame = 0;
  std::size_t reading = 0;
};

/// A recording as its map grows.
struct Recording {
  std::shared_ptr<const CameraModel> camera;
  std::vector<RecordedFrame> frames;
  /// The seed's markers first.
  std::vector<RecordedMarker> markers;

  /// Takes all markers of the seed, and one at an unknown place for each other id that is read.
  Recording(std::shared_ptr<const CameraModel> camera, const std::vector<FrameReadings>& inputs,
            const MarkerMap& seed, double size);

  /// The readings of a marker in frames that have a pose, or in all frames.
  std::vector<ReadingIndex> readingsOf(std::size_t marker, bool with_pose_only = true) const;
  MarkerSighting sighting(const ReadingIndex& place) const;
  std::vector<MarkerSighting> sightings(const std::vector<ReadingIndex>& places) const;

  /// The markers whose places are known, and their indices in this recording.
  MarkerMap placedMap(std::vector<std::size_t>* indices) const;

  std::size_t framesWithPose() const;
};

/// "marker 7 (door)".
std::string nameOf(const Marker& marker);

}  // namespace omnitag
