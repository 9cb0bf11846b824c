#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/localization/pose_estimator.h"
#include "omnitag/marker/glance_reader.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_reader.h"
#include "omnitag/marker/tag_pattern.h"

namespace omnitag {

/// What a localizer looks with.
struct TrackingTools {
  const MarkerMap& map;
  const MarkerIndex& index;
  const LocalizerConfig& config;
  const MarkerReader& reader;
  const GlanceReader& glance_reader;
  const TagPatterns& patterns;
};

/// Finds the predicted markers of one frame, by their patterns where their places are known well
/// enough, by decoding views otherwise, and the pose that they give. Everything that is seen goes
/// to the frame's result.
class FrameTracker {
 public:
  /// All must outlive the tracker. `result->predicted` holds what is to be found.
  FrameTracker(const TrackingTools& tools, const Frame& frame, const MountedCamera& camera,
               const PoseEstimate& predicted, FrameResult* result);

  /// The pose, the prediction included; nothing where no marker agrees with any. `glance` is
  /// counted up from frame to frame: of the markers that were not found though the pose is certain,
  /// it says which one is looked at with the decoder, to see what is there instead. Without it, as
  /// for a prediction in doubt, few are decoded where markers can be recognized.
  std::optional<PoseEstimate> track(std::optional<std::size_t> glance = std::nullopt);

 private:
  /// What became of a predicted marker.
  struct Sighting {
    std::optional<MarkerObservation> observation;
    bool was_decoded = false;
  };

  /// Looks for the patterns of the markers that were not found, the largest first, until so many
  /// are found.
  void recognize(const PoseEstimate& belief, std::size_t enough);
  /// Looks for the patterns of all markers that were not found.
  void recognizeAll(const PoseEstimate& belief);
  std::optional<MarkerObservation> recognizeOne(std::size_t target,
                                                const PoseEstimate& belief) const;
  /// Decodes views of these markers that have no more than so many pixels.
  void decode(const std::vector<std::size_t>& targets, double max_pixels);
  /// Those that were not found yet, the largest first.
  std::vector<std::size_t> missing() const;
  /// Those of them that the decoder may still be able to read.
  std::vector<std::size_t> undecoded() const;
  std::size_t found() const;
  void solve();
  /// Aligns the solution with the pixels, unless a marker is then off that was not before.
  void align();
  void report();
  void addViews();
  /// Views around these predicted markers, which their targets name.
  std::vector<View> viewsOf(const std::vector<std::size_t>& targets) const;

  const TrackingTools& tools_;
  const Frame& frame_;
  const MountedCamera& camera_;
  const PoseEstimate& predicted_;
  FrameResult* result_;
  std::vector<Sighting> sightings_;
  /// What was decoded and is none of the predicted markers.
  std::vector<MarkerDetection> strangers_;
  std::optional<PoseSolution> solution_;
  /// Indices of the sightings that the solution is based on, in the order of its residuals.
  std::vector<std::size_t> observed_;
};

/// A reading as a detection that is not accepted yet.
MarkerDetection toDetection(const MarkerReading& reading);
/// The same of a marker of the map that was observed.
MarkerDetection toDetection(const MarkerObservation& observation, const Marker& marker);

/// Reads views and adds them, with what they show, to the result.
std::vector<MarkerReading> readViews(const TrackingTools& tools, const cv::Mat& panorama,
                                     std::vector<View> views, FrameResult* result);

/// The marker at an entry of the map, where its pattern is found about where `belief` has it.
std::optional<MarkerObservation> recognizeMarker(const TrackingTools& tools,
                                                 const cv::Mat& panorama,
                                                 const MountedCamera& camera, std::size_t entry,
                                                 const PoseEstimate& belief);

/// Pixels that a marker may be off the final pose. One that was recognized from a worse belief is
/// tilted and scaled a little: that may be some pixels where it is large, about half a module.
double residualLimit(const MarkerObservation& recognized, const LocalizerConfig& config);

/// A pose aligned with the pixels of the markers at `entries`; nothing where that is not asked for
/// or not possible.
std::optional<PoseEstimate> alignWithPixels(const TrackingTools& tools, const cv::Mat& panorama,
                                            const MountedCamera& camera,
                                            const std::vector<std::size_t>& entries,
                                            const Pose2& initial,
                                            const std::optional<PoseEstimate>& prior);

/// A pose that stands on the corners of so many markers, although it was to be aligned with pixels:
/// of a marker or two alone, corners may be much farther off than they are where many agree.
PoseEstimate standingOnCorners(const PoseEstimate& pose, std::size_t markers,
                               const LocalizerConfig& config);

}  // namespace omnitag
