#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/marker_memory.h"
#include "localization/observation.h"
#include "marker/glance_reader.h"
#include "marker/marker_index.h"
#include "marker/marker_reader.h"
#include "marker/sharpening.h"
#include "marker/tag_pattern.h"
#include "measurement/pose_prior.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/marker/marker_map.h"
#include "photometry/photometric_refinement.h"

namespace omnitag {

/// Why a marker that was moved is not accepted.
constexpr const char* kElsewhere = "hangs elsewhere than the map says";

/// What a localizer needs to look at a frame.
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
  /// The excess of LastingDisagreement.
  double lasting_excess;
  /// The frame's image for decoding.
  ReadableImage& readable;
};

/// Whether an observation agrees with a prior: by its corners, and by the pose that they lead to.
bool agreesWithPrior(const MarkerMap& map, const EstimatorConfig& config,
                     const MountedCamera& camera, const MarkerObservation& observation,
                     const PosePrior& prior);

/// A reading as a detection that is not accepted yet.
MarkerDetection toDetection(const MarkerReading& reading);
/// The same for an observation.
MarkerDetection toDetection(const MarkerObservation& observation, const Marker& marker);

/// Reads views and adds them, with their images, to the result.
std::vector<MarkerReading> readViews(const TrackingTools& tools, std::vector<View> views,
                                     FrameResult* result);

/// Whether a marker's place is known well enough for its pattern to be looked for.
bool isPlaceKnown(const TrackingTools& tools, const MountedCamera& camera,
                  const PredictedMarker& predicted);

/// The marker at a map entry, if its pattern is found near its projection from `belief`.
std::optional<MarkerObservation> recognizeMarker(const TrackingTools& tools,
                                                 const cv::Mat& panorama,
                                                 const MountedCamera& camera, std::size_t entry,
                                                 const PoseEstimate& belief);

/// The same, near the prediction from a pose.
std::optional<MarkerObservation> recognizePredicted(const TrackingTools& tools,
                                                    const cv::Mat& panorama,
                                                    const MountedCamera& camera,
                                                    const Pose& map_from_base,
                                                    const PredictedMarker& predicted);

/// The other pose from which a single marker looks almost the same, if there is one.
std::optional<Pose> otherPose(const TrackingTools& tools, const Marker& marker,
                              const MountedCamera& camera, const Pose& map_from_base);

/// A pose aligned with the pixels of the markers at `entries`; nothing if that is not configured or
/// not possible.
std::optional<PhotometricFit> alignWithPixels(const TrackingTools& tools, const cv::Mat& panorama,
                                              const MountedCamera& camera,
                                              const std::vector<std::size_t>& entries,
                                              const Pose& initial, const PosePrior& prior);

/// A pose that is based on the corners of this many markers although it was meant to be aligned
/// with pixels, with a wider covariance: the corners of only one or two markers may be much farther
/// off than those of many that agree.
PoseEstimate standingOnCorners(const PoseEstimate& pose, std::size_t markers,
                               const LocalizerConfig& config);

}  // namespace omnitag
