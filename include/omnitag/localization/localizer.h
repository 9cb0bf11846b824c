#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "omnitag/camera/camera_model.h"
#include "omnitag/camera/shutter_config.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// A camera that a localizer looks through.
struct LocalizerCamera {
  std::shared_ptr<const CameraModel> model;
  /// If none, the one in LocalizerConfig.
  std::optional<ShutterConfig> shutter = std::nullopt;
};

/// Follows a robot through a stream of images: predicts, looks, triangulates, judges; and looks all
/// around if it has no pose, or none that agrees with the image. The images of several cameras
/// update one belief.
///
/// The same input gives the same result. Not safe to use from two threads at once.
class Localizer {
 public:
  /// Throws InputError if the map names a family that the AprilTag library does not have.
  Localizer(std::vector<LocalizerCamera> cameras, MarkerMap map, const LocalizerConfig& config);
  Localizer(std::shared_ptr<const CameraModel> camera, MarkerMap map,
            const LocalizerConfig& config);
  ~Localizer();

  /// s: how much older an image may be than the last one of another camera.
  static constexpr double kMaxOvertaken = 0.5;

  /// Takes base_link's pose in the map from outside, as a hypothesis
  /// (MotionModelConfig::max_initial_…). `odom_from_base`: odometry when the robot was there, from
  /// which frames with odometry carry the pose on; if absent, the robot is there at the stamp of
  /// the next frame.
  void setPose(const PoseEstimate& map_from_base,
               const std::optional<Pose>& odom_from_base = std::nullopt);

  /// The same without a covariance, using the configured initial deviations.
  void setPose(const Pose& map_from_base, const std::optional<Pose>& odom_from_base = std::nullopt);

  /// Forgets the pose; the next frames search.
  void forgetPose();

  /// Replaces the map by one that has markers appended, or some of the existing ones moved. Throws
  /// InputError as the constructor does; a family that the map did not name before must be its
  /// default.
  void setMap(MarkerMap map);

  /// Continues from the state of another localizer with the same cameras but another map or other
  /// settings: takes over its pose, and what it knows of markers that this map has in the same
  /// places. Call it before the first image.
  void continueFrom(const Localizer& before);

  /// Takes markers that the map does not have, at the places where they seem to hang; exploring
  /// (LocalizerConfig::exploring_views) then looks for them there, too.
  void seek(const std::vector<Marker>& markers);

  /// Processes a frame. The stamps of each camera must increase and be at most kMaxOvertaken older
  /// than those of other cameras, and frame.image must have the camera's size; otherwise throws
  /// InputError and keeps its state.
  FrameResult process(const Frame& frame);

  const MarkerMap& map() const;
  const CameraModel& camera(std::size_t index = 0) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace omnitag
