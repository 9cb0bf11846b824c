#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/localization/marker_memory.h"
#include "omnitag/localization/observation.h"
#include "omnitag/marker/glance_reader.h"
#include "omnitag/marker/marker_index.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_reader.h"
#include "omnitag/marker/sharpening.h"
#include "omnitag/marker/tag_pattern.h"

namespace omnitag {

/// Why a marker is not accepted that was moved.
constexpr const char* kElsewhere = "hangs elsewhere than the map says";

/// What a localizer looks with.
struct TrackingTools {
  const MarkerMap& map;
  const MarkerIndex& index;
  const LocalizerConfig& config;
  const MarkerReader& reader;
  const GlanceReader& glance_reader;
  const TagPatterns& patterns;
  /// What is known of a pose without a prediction.
  const PosePrior& standing;
  const MarkerMemory& memory;
  /// LastingDisagreement's.
  double lasting_excess;
  /// The frame's image for decoders.
  ReadableImage& readable;
};

/// Whether a marker that was observed is where a prior allows it to be: by the corners, and by what
/// they make of the pose.
bool agreesWithPrior(const TrackingTools& tools, const MountedCamera& camera,
                     const MarkerObservation& observation, const PosePrior& prior);

/// A reading as a detection that is not accepted yet.
MarkerDetection toDetection(const MarkerReading& reading);
/// The same of a marker of the map that was observed.
MarkerDetection toDetection(const MarkerObservation& observation, const Marker& marker);

/// Reads views and adds them, with what they show, to the result.
std::vector<MarkerReading> readViews(const TrackingTools& tools, std::vector<View> views,
                                     FrameResult* result);

/// Whether a marker's place is known well enough for its pattern to be looked for.
bool isPlaceKnown(const TrackingTools& tools, const MountedCamera& camera,
                  const PredictedMarker& predicted);

/// The marker at an entry of the map, where its pattern is found near its projection by `belief`.
std::optional<MarkerObservation> recognizeMarker(const TrackingTools& tools,
                                                 const cv::Mat& panorama,
                                                 const MountedCamera& camera, std::size_t entry,
                                                 const PoseEstimate& belief);

/// The same where it images, about, from a pose.
std::optional<MarkerObservation> recognizePredicted(const TrackingTools& tools,
                                                    const cv::Mat& panorama,
                                                    const MountedCamera& camera,
                                                    const Pose& map_from_base,
                                                    const PredictedMarker& predicted);

/// The other pose from which a single marker looks almost the same, if there is one.
std::optional<Pose> otherPose(const TrackingTools& tools, const Marker& marker,
                              const MountedCamera& camera, const Pose& map_from_base);

/// A pose aligned with the pixels of the markers at `entries`; nothing where that is not asked for
/// or not possible.
std::optional<PhotometricFit> alignWithPixels(const TrackingTools& tools, const cv::Mat& panorama,
                                              const MountedCamera& camera,
                                              const std::vector<std::size_t>& entries,
                                              const Pose& initial, const PosePrior& prior);

/// A pose that stands on the corners of this many markers, although it was to be aligned with
/// pixels: of a marker or two alone, corners may be much farther off than they are where many
/// agree.
PoseEstimate standingOnCorners(const PoseEstimate& pose, std::size_t markers,
                               const LocalizerConfig& config);

}  // namespace omnitag
