#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "omnitag/camera/mounted_camera.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/image_lag.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/localization/marker_memory.h"
#include "omnitag/localization/motion_model.h"
#include "omnitag/marker/glance_reader.h"
#include "omnitag/marker/marker_map.h"
#include "omnitag/marker/marker_reader.h"
#include "omnitag/marker/sharpening.h"
#include "omnitag/marker/tag_pattern.h"

namespace omnitag {

class Patrol;
struct TrackingTools;

/// Follows a robot through a stream of images: predicts, looks, triangulates, judges; and looks all
/// around where it has no pose, or none that the image agrees with.
///
/// Same input, same result. Not safe to use from two threads at once.
class Localizer {
 public:
  /// Throws InputError where the map names a family that the AprilTag library does not have.
  Localizer(std::shared_ptr<const CameraModel> camera, MarkerMap map,
            const LocalizerConfig& config);
  ~Localizer();

  /// Takes base_link's pose in the map from outside, as a hypothesis
  /// (MotionModelConfig::max_initial_…). `odom_from_base`: odometry when the robot was there, from
  /// which frames with odometry carry it on; none: it is there at the stamp of the next frame.
  void setPose(const PoseEstimate& map_from_base,
               const std::optional<Pose>& odom_from_base = std::nullopt);

  /// The same without a covariance: the configured initial deviations are taken.
  void setPose(const Pose& map_from_base, const std::optional<Pose>& odom_from_base = std::nullopt);

  /// Forgets the pose; the next frames search.
  void forgetPose();

  /// Takes the map with markers added behind those that it had, or with some of those moved. Throws
  /// InputError as the constructor does; a family that the map did not name before must be its
  /// default.
  void setMap(MarkerMap map);

  /// Goes on where another localizer of the same camera stands, whose map or settings were others:
  /// with its pose, and with what it knows of markers that this map has in the same places. To be
  /// called before the first image.
  void continueFrom(const Localizer& before);

  /// Takes markers that the map does not have, and where they seem to hang: exploring
  /// (LocalizerConfig::exploring_views) looks for them there, too.
  void seek(std::vector<Marker> markers);

  /// Stamps must increase; frame.image must have the camera's size. Throws InputError otherwise and
  /// keeps its state.
  FrameResult process(const Frame& frame);

  const MarkerMap& map() const { return map_; }
  const CameraModel& camera() const { return *camera_; }

 private:
  void check(const Frame& frame) const;
  std::optional<PoseEstimate> predict(const Frame& frame);
  /// The camera while it takes the frame's image. After predict().
  MountedCamera cameraOf(const Frame& frame, bool has_prediction) const;
  /// Looks where the prediction has markers; leaves the result without a pose where none agrees.
  /// Whether what was found there leaves the prediction possible.
  bool track(const Frame& frame, const MountedCamera& camera, const PoseEstimate& predicted,
             FrameResult* result);
  /// The pose of the markers that are found about where the prediction has them, and the blur with
  /// which they are found best.
  std::optional<PoseEstimate> followMarkers(const Frame& frame, const MountedCamera& camera,
                                            const PoseEstimate& predicted, FrameResult* result);
  /// A pose less certain by what the images' lag makes of the robot's motion, if they seem to lag.
  PoseEstimate withLag(const Frame& frame, const PoseEstimate& predicted, const PoseEstimate& pose);
  /// Of an image in which the robot was found.
  void learnBlur(const Frame& frame, const MountedCamera& camera, FrameResult* result);
  /// Pixels, standard deviation of the blur that decoders are to read without.
  double blurToRead();
  /// Whether the accepted markers alone, without the prediction, lead to where it has the robot. A
  /// prediction that is too sure of itself may hold a pose against all of them.
  bool markersAgree(const MountedCamera& camera, const PoseEstimate& predicted,
                    const Pose& solution, const FrameResult& result) const;
  /// Whether a look all around, now and then where only a marker or two are found and one is missed
  /// that the frame before showed, finds the robot elsewhere. What it reads is not lost to
  /// exploring.
  bool isElsewhere(const Frame& frame, const MountedCamera& camera, const PoseEstimate& tracked,
                   FrameResult* result);
  /// Looks all around, and decides between what it finds and the prediction.
  void search(const Frame& frame, const MountedCamera& camera,
              const std::optional<PoseEstimate>& predicted, bool is_refuted, FrameResult* result);
  /// A pose that no reading of a look around tells by itself, but with others that are recognized
  /// from there; these are then in the result.
  std::optional<PoseEstimate> confirmAround(const std::vector<MarkerReading>& readings,
                                            const Frame& frame, const MountedCamera& camera,
                                            FrameResult* result);
  /// Whether a pose that a search found replaces the expected one. `for_expected`: entries that
  /// were seen where only that has them.
  Verdict weigh(const Frame& frame, const Pose& expected, const Pose& found,
                const std::vector<std::size_t>& for_expected, const FrameResult& result) const;
  /// Those of the map's markers that a search read where only the predicted pose has them.
  std::vector<std::size_t> entriesWherePredicted(const MountedCamera& camera,
                                                 const PoseEstimate& predicted,
                                                 const FrameResult& result);
  /// Takes a pose that a search found, unless what it stands on was moved more likely than the
  /// robot.
  void decide(const PoseEstimate& pose, const Frame& frame, const MountedCamera& camera,
              const std::optional<PoseEstimate>& predicted, bool is_expected, FrameResult* result);
  /// Leaves the frame without a pose, since two are possible.
  void withhold(FrameResult* result);
  /// Takes a pose that was found without the prediction, or agrees with it.
  void settle(const PoseEstimate& pose, const Frame& frame,
              const std::optional<PoseEstimate>& predicted, bool is_expected, FrameResult* result);
  /// Without a marker that agrees: the prediction, unless what was read contradicts it.
  void carryOn(const PoseEstimate& predicted, bool is_refuted, FrameResult* result) const;
  TrackingTools trackingTools();
  /// Keeps which markers the frame showed and which not.
  void remember(const MountedCamera& camera, const FrameResult& result);
  /// Fills in what the frame's pose says about its detections.
  void measure(const MountedCamera& camera, FrameResult* result);
  /// Whether it is time to see how far a marker hangs from its place; if so, it is then done.
  bool isDue(const MarkerDetection& rejected, double stamp);

  std::shared_ptr<const CameraModel> camera_;
  MarkerMap map_;
  MarkerIndex index_;
  LocalizerConfig config_;
  MarkerReader reader_;
  GlanceReader glance_reader_;
  TagPatterns patterns_;
  MotionModel motion_;
  MarkerMemory memory_;
  Evidence evidence_;
  /// What was known of the first of the poses that this one goes back to; none where markers told
  /// it.
  std::optional<PosePrior> start_;
  std::unique_ptr<Patrol> patrol_;
  BlurFilter blur_;
  LastingDisagreement disagreement_;
  ImageLag image_lag_;
  /// The frame's image as decoders read it.
  ReadableImage readable_;
  /// How the robot stands, as far as is known without a prediction.
  PosePrior standing_;
  /// A pose that was set and waits for the next frame.
  struct GivenPose {
    PoseEstimate map_from_base;
    std::optional<Pose> odom_from_base;
  };
  std::optional<GivenPose> given_pose_;
  std::optional<double> last_stamp_;
  /// Stamp of the last image whose markers told a pose.
  double seen_stamp_ = std::numeric_limits<double>::infinity();
  /// Stamp from which a pose that stands on few markers is doubted next.
  double next_doubt_ = -std::numeric_limits<double>::infinity();
  /// By family and id: when it was last seen how far a marker hangs from its place.
  std::map<std::pair<std::string, int>, double> measured_;
  /// Since markers told a pose.
  int lost_frames_ = 0;
  /// Whether markers told the pose of the image before.
  bool was_tracked_ = false;
  bool has_pose_ = false;
};

}  // namespace omnitag
