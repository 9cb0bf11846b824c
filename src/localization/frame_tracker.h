#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "frame_steps.h"
#include "omnitag/camera/mounted_camera.h"
#include "omnitag/localization/frame_result.h"
#include "omnitag/localization/pose_estimator.h"

namespace omnitag {

/// Finds the predicted markers of one frame, by their patterns where their places are known well
/// enough, by decoding views otherwise, and the pose that they give. Everything that is seen goes
/// to the frame's result.
class FrameTracker {
 public:
  /// All must outlive the tracker. `result->predicted` holds what is to be found. `turn` is
  /// counted up from frame to frame: of the markers that were not found though the pose is certain,
  /// it says which one is looked at with the decoder, to see what is there instead. Without it, as
  /// for a prediction that readings of the same frame gave, the pose is that of the markers alone,
  /// and few are decoded where they can be recognized.
  FrameTracker(const TrackingTools& tools, const Frame& frame, const MountedCamera& camera,
               const PoseEstimate& predicted, std::optional<std::size_t> turn, FrameResult* result);

  /// The pose; nothing where no marker agrees with any.
  std::optional<PoseEstimate> track();

 private:
  /// What became of a predicted marker.
  struct Sighting {
    std::optional<MarkerObservation> observation;
    bool was_decoded = false;
  };
  /// What was decoded and is none of the predicted markers, and why.
  struct Stranger {
    MarkerReading reading;
    std::string reason;
  };

  /// Looks for the patterns of the markers that were not found, the largest first, until so many
  /// are found.
  void recognize(const PoseEstimate& belief, std::size_t enough);
  /// Looks for the patterns of all others and solves again: once more where the solution told too
  /// little of where they are.
  void findOthers();
  /// Looks for the patterns of all that were not found; whether it found one.
  bool recognizeAll(const PoseEstimate& belief);
  std::optional<MarkerObservation> recognizeOne(std::size_t target,
                                                const PoseEstimate& belief) const;
  /// Decodes views of these markers that have no more than so many pixels.
  void decode(const std::vector<std::size_t>& targets, double max_pixels);
  /// Those that were not found yet, the largest first.
  std::vector<std::size_t> missing() const;
  /// Those of them that the decoder may still be able to read.
  std::vector<std::size_t> undecoded() const;
  std::size_t found() const;
  /// Whether the solution is off the prediction, or leaves out some that were found, while too few
  /// agree with it sharply for these to be sure to be the ones that hang where the map has them.
  bool isDoubtful() const;
  /// Looks for the patterns of all from a pose, as far around as is possible and for however much
  /// they are slanted, and solves again: what was recognized from a pose that is wrong is drawn a
  /// little toward that pose. Where that finds more, the others are looked for again as well. Keeps
  /// what was where no pose agrees then.
  void lookAgain(const Pose& pose);
  PoseModel poseModel() const { return tools_.config.motion.pose_model; }
  /// The prior of a robot that was pushed as far as anybody may.
  PosePrior farthestPushed() const;
  /// Estimates the pose from what was found. Where markers agree that the robot is elsewhere than
  /// predicted, what moved it is not in the prediction: it counts for less from then on.
  void solve();
  /// Aligns the solution with the pixels of its markers, but for those that are then off; leaves it
  /// with the corners where others are off without them.
  void align();
  void report();
  void addViews();
  /// Views around these predicted markers, which their targets name.
  std::vector<View> viewsOf(const std::vector<std::size_t>& targets) const;

  const TrackingTools& tools_;
  const Frame& frame_;
  const MountedCamera& camera_;
  const PoseEstimate& predicted_;
  std::optional<std::size_t> turn_;
  /// What is known of the pose beside what is found.
  PosePrior prior_;
  FrameResult* result_;
  std::vector<Sighting> sightings_;
  /// Each once.
  std::vector<Stranger> strangers_;
  std::optional<PoseSolution> solution_;
  /// Indices of the sightings that the solution is based on, in the order of its residuals.
  std::vector<std::size_t> observed_;
};

}  // namespace omnitag
