#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/evidence.h"
#include "localization/hypothesis.h"
#include "localization/image_lag.h"
#include "marker/marker_index.h"
#include "marker/tag_pattern.h"
#include "omnitag/common/pose.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/localization/localizer_config.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

struct Branch;
struct CameraState;
struct TrackingTools;

/// What a Localizer is made of. Localizer says what the public functions do.
class Localizer::Impl {
 public:
  Impl(std::vector<LocalizerCamera> cameras, MarkerMap map, const LocalizerConfig& config);
  void setPose(const PoseEstimate& map_from_base, const std::optional<Pose>& odom_from_base);
  void setPose(const Pose& map_from_base, const std::optional<Pose>& odom_from_base);
  void forgetPose();
  void setMap(MarkerMap map);
  void continueFrom(const Impl& before);
  void seek(const std::vector<Marker>& markers);
  FrameResult process(const Frame& frame);
  const MarkerMap& map() const { return map_; }
  const CameraModel& camera(std::size_t index) const;

 private:
  void check(const Frame& frame) const;
  /// Carries all hypotheses on to the frame and returns their poses, which are of no use for
  /// hypotheses that are then lost.
  std::vector<PoseEstimate> predict(const Frame& frame);
  CameraState& stateOf(const Frame& frame) { return *cameras_[frame.camera]; }
  /// Whether an image of another camera has just given the pose.
  bool isSeenByAnother(const Frame& frame) const;
  /// The camera while it takes the frame's image. To be called after predict().
  MountedCamera cameraOf(const Frame& frame);
  /// Whether no hypothesis has a pose.
  bool isLost() const;

  /// The branches of the frame for all hypotheses, and for others that they lead to.
  std::vector<Branch> track(const Frame& frame, const MountedCamera& camera,
                            const std::vector<PoseEstimate>& predicted);
  std::vector<Branch> track(const Frame& frame, const MountedCamera& camera,
                            const Hypothesis& before, const PoseEstimate& predicted,
                            bool is_likeliest, std::vector<MarkerObservation>* seen);
  /// The pose from the markers that are found near their predictions, the blur that finds them
  /// best, and other poses that they may indicate.
  std::optional<PoseEstimate> followMarkers(const TrackingTools& tools, const Frame& frame,
                                            const MountedCamera& camera,
                                            const PoseEstimate& predicted, bool learns,
                                            FrameResult* result,
                                            std::vector<MarkerObservation>* seen,
                                            std::vector<PoseEstimate>* alternatives);
  /// The branches of the frame for a robot at another pose than in `branch`.
  std::vector<Branch> alternativesAt(const PoseEstimate& pose, const Frame& frame,
                                     const MountedCamera& camera, const Hypothesis& before,
                                     const Branch& branch,
                                     const std::vector<MarkerObservation>& seen);
  /// A pose, its covariance widened for the robot's motion if the images seem to lag.
  PoseEstimate withLag(const Frame& frame, const PoseEstimate& predicted, const PoseEstimate& pose,
                       bool learns);
  /// Whether the accepted markers alone, without the prediction, lead to the predicted place. An
  /// overconfident prediction may hold the pose there against all of them.
  bool markersAgree(const MountedCamera& camera, const PoseEstimate& predicted,
                    const Pose& solution, const FrameResult& result) const;
  /// Whether a look all around finds the robot elsewhere. It is only done now and then, if at most
  /// two markers are found and one that the last frame showed is missing. Exploring keeps what it
  /// reads.
  bool isElsewhere(const TrackingTools& tools, const Frame& frame, const MountedCamera& camera,
                   const Hypothesis& hypothesis, const PoseEstimate& tracked, FrameResult* result);

  /// Searches for a robot that is lost, or seems not to be where its branch puts it; returns that
  /// branch and those for the place where the robot is found.
  std::vector<Branch> lookFor(const Frame& frame, const MountedCamera& camera, Branch branch,
                              const std::optional<PoseEstimate>& predicted, bool is_refuted);
  /// Looks all around; nothing if that gives no pose that overrules the prediction.
  std::optional<PoseEstimate> search(const TrackingTools& tools, const Frame& frame,
                                     const MountedCamera& camera,
                                     const std::optional<PoseEstimate>& predicted,
                                     FrameResult* result);

  /// Completes the detections with what follows from the frame's pose.
  void measure(const MountedCamera& camera, FrameResult* result);
  /// Learns from an image if the robot's pose is settled.
  void learnFrom(const Frame& frame, const MountedCamera& camera, bool was_searched,
                 FrameResult* result);
  void learnBlur(const Frame& frame, const MountedCamera& camera, FrameResult* result);
  /// Pixels: standard deviation of the blur to remove for decoders.
  static double blurToRead(CameraState* state);
  TrackingTools trackingTools(const Frame& frame, const Hypothesis& hypothesis);
  /// Whether it is time to measure how far a marker hangs from its place; if so, notes it as
  /// measured.
  bool isDue(const MarkerDetection& rejected, double stamp);

  MarkerMap map_;
  MarkerIndex index_;
  LocalizerConfig config_;
  std::vector<std::unique_ptr<CameraState>> cameras_;
  TagPatterns patterns_;
  Evidence evidence_;
  /// The likeliest first. There is always one: for a lost robot, it holds what was last known of
  /// the markers and of how the robot stands.
  std::vector<Hypothesis> hypotheses_;
  ImageLag image_lag_;
  /// How the robot stands, as far as is known without a prediction.
  PosePrior standing_;
  /// A pose that was set and waits for the next frame.
  struct GivenPose {
    PoseEstimate map_from_base;
    std::optional<Pose> odom_from_base;
  };
  std::optional<GivenPose> given_pose_;
  std::optional<double> last_stamp_;
  /// Stamp from which a pose based on few markers may next be doubted.
  double next_doubt_ = -std::numeric_limits<double>::infinity();
  /// By family and id: when it was last measured how far a marker hangs from its place.
  std::map<std::pair<std::string, int>, double> measured_;
  /// Whether markers gave the pose of the last image of any camera.
  bool was_tracked_ = false;
};

}  // namespace omnitag
