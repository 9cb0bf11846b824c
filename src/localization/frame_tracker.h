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
  /// All must outlive the tracker. `result->predicted` holds what is to be found. `has_prior`:
  /// whether the prediction is a prior. Otherwise, as where readings of the same frame gave it, the
  /// pose is that of the markers alone, and few are decoded where they can be recognized.
  FrameTracker(const TrackingTools& tools, const Frame& frame, const MountedCamera& camera,
               const PoseEstimate& predicted, bool has_prior, FrameResult* result);

  /// Takes markers that were already found in the image, from other poses: they are not looked for
  /// again.
  void takeSeen(const std::vector<MarkerObservation>& seen);

  /// The pose; nothing where no marker agrees with any.
  std::optional<PoseEstimate> track();

  /// All that was found, wherever it hangs.
  std::vector<MarkerObservation> seen() const;

  /// Other poses, to which markers lead that this one does not explain.
  const std::vector<PoseEstimate>& alternatives() const { return alternatives_; }

 private:
  /// What became of a predicted marker.
  struct Sighting {
    std::optional<MarkerObservation> observation;
    /// Where its pattern was looked for, once its place was known well enough.
    std::optional<PredictedMarker> looked_at;
    bool was_decoded = false;
    /// What MarkerMemory says: whether it was seen before, or hardly can be and is not looked for.
    bool is_likely = false;
    bool is_hidden = false;
    /// Whether it hangs elsewhere than the map says.
    bool is_elsewhere = false;
  };
  /// What was decoded and is none of the predicted markers, and why.
  struct Stranger {
    MarkerReading reading;
    std::string reason;
  };

  void remember();
  /// Looks for the patterns of the markers that were not found, the likeliest first, until this
  /// many are found.
  void recognize(const PoseEstimate& belief, std::size_t enough);
  /// Looks for the patterns of all others and solves again: once more where the solution told too
  /// little of where they are.
  void findOthers();
  /// Looks for the patterns of all that were not found, or of the likely ones; whether it found
  /// one.
  bool recognizeAll(const PoseEstimate& belief, bool are_only_likely);
  /// Looks for the pattern of one near its projection from a pose, which must be known that well.
  void recognizeOne(std::size_t target, const PoseEstimate& belief);
  /// Decodes views of the likeliest, one after another, until two markers are found.
  void decodeAnchors();
  /// Decodes views of these markers that have at most this many pixels.
  void decode(const std::vector<std::size_t>& targets, double max_pixels);
  /// Those that were not found yet and that nothing hides, the likely ones first, then the largest.
  std::vector<std::size_t> missing() const;
  /// Those of them that the decoder may still be able to read.
  std::vector<std::size_t> undecoded() const;
  /// Those of them whose patterns could not be looked for.
  std::vector<std::size_t> undecided() const;
  /// How many are found or hidden by nothing.
  std::size_t expected() const;
  std::size_t found() const;
  /// Whether the solution is so far off the prediction that other markers may be where that has
  /// them.
  bool isSurprising() const;
  /// Looks for the others there, also with the decoder.
  void lookWherePredicted();
  /// Whether the solution is off the prediction, or leaves out some that were found, while too few
  /// agree with it sharply for these to be surely the ones that hang in their places.
  bool isDoubtful() const;
  /// Looks for the patterns of all from a pose, far around and for however much they are slanted,
  /// and solves again: what was recognized from a pose that is wrong is drawn a little toward that
  /// pose. Where that finds more, the others are looked for again as well. Keeps what was where no
  /// pose agrees then.
  void lookAgain(const Pose& pose);
  bool recognizes() const { return tools_.config.estimation.kind == EstimatorKind::kPhotometric; }
  PoseModel poseModel() const { return tools_.config.motion.pose_model; }
  /// The prior of a robot that was pushed as far as anybody may.
  PosePrior farthestPushed() const;
  /// What remains of the prior once markers told the pose without it: less where they contradict,
  /// since the robot was then moved by as much as it seems, or some times that.
  PosePrior afterPush(const PoseEstimate& alone) const;
  /// Estimates the pose from what was found. Where markers agree that the robot is elsewhere than
  /// predicted, what moved it is not in the prediction: it counts for less from then on.
  void solve();
  std::optional<PoseSolution> solutionOfObserved(const PosePrior& prior);
  /// Those of `observed_`.
  std::vector<MarkerObservation> observations() const;
  /// Where markers lead to another pose than the prediction does, or than others do: keeps to the
  /// prediction or the others, and notes the pose.
  void settleConflicts();
  void settleWithPrediction();
  void settleAmongMarkers();
  /// Leaves out those that hung elsewhere in the images before, unless they are in their places as
  /// the others put it, or, without others, the prediction.
  void leaveOutKnown();
  /// Whether a marker hangs elsewhere according to a solution: beside its place, or rather where a
  /// group does that was moved. `was_known`: whether it did so before.
  bool isDisplaced(const MarkerObservation& observation, const PoseSolution& solution,
                   const std::vector<Eigen::Isometry3d>& motions, bool was_known) const;
  /// Whether one that did so before is in its place by the prior, and not where a group is.
  bool mayBeInPlace(const MarkerObservation& observation,
                    const std::vector<Eigen::Isometry3d>& motions) const;
  /// Standard deviations (Misfit) by which a marker is off at most that hangs in its place.
  double mostInPlace() const;
  /// Notes the pose that these tell by themselves, if they do.
  void noteAlternative(const std::vector<MarkerObservation>& observations);
  void leaveOut(const std::vector<std::size_t>& targets);
  /// Aligns the solution with the pixels of its markers, but for those that are then off; leaves it
  /// with the corners where others are off without them.
  void align();
  std::vector<std::size_t> usedEntries() const;
  std::optional<PhotometricFit> alignedWith(const std::vector<std::size_t>& entries);
  /// Where the pixels of markers disagree about the pose by more than chance: goes on with those
  /// that agree, and notes the pose of the others. `prior`: before these pushed it.
  bool leaveOutDisagreeing(const PhotometricFit& fit, const PosePrior& prior);
  /// The same of those whose corners are off the pose that the pixels of others tell.
  /// `misfits`: of what was observed, at that pose.
  bool leaveOutFar(const PhotometricFit& fit, const std::vector<Misfit>& misfits);
  /// Takes an aligned pose, unless corners are off it.
  bool take(const PhotometricFit& fit, std::vector<Misfit> misfits);
  void report();
  void reportMissed();
  void addViews();
  /// Views around these predicted markers, which their targets name.
  std::vector<View> viewsOf(const std::vector<std::size_t>& targets) const;

  const TrackingTools& tools_;
  const Frame& frame_;
  const MountedCamera& camera_;
  const PoseEstimate& predicted_;
  bool has_prior_;
  /// What is known of the pose beside what is found, and whether that is less than the prediction
  /// says, since something moved the robot.
  PosePrior prior_;
  bool is_pushed_ = false;
  FrameResult* result_;
  std::vector<Sighting> sightings_;
  /// Each once.
  std::vector<Stranger> strangers_;
  std::optional<PoseSolution> solution_;
  std::vector<PoseEstimate> alternatives_;
  /// Indices of the sightings that the solution is based on, in the order of its residuals.
  std::vector<std::size_t> observed_;
};

}  // namespace omnitag
