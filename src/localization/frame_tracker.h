#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "camera/mounted_camera.h"
#include "localization/frame_steps.h"
#include "localization/pose_estimator.h"
#include "omnitag/localization/frame_result.h"
#include "photometry/recognition.h"

namespace omnitag {

/// Finds the predicted markers of one frame and the pose that they give: by their patterns if their
/// places are known well enough, otherwise by decoding views. Everything that is seen goes to the
/// frame's result.
class FrameTracker {
 public:
  /// All must outlive the tracker. `result->predicted` holds what to find. `has_prior`: whether the
  /// prediction counts as a prior. If not, for example because readings of the same frame gave it,
  /// the pose comes from the markers alone, and few are decoded if they can be recognized.
  FrameTracker(const TrackingTools& tools, const Frame& frame, const MountedCamera& camera,
               const PoseEstimate& predicted, bool has_prior, FrameResult* result);

  /// Takes markers that were already found in the image from other poses and need not be looked for
  /// again.
  void takeSeen(const std::vector<MarkerObservation>& seen);

  /// The pose; nothing if no marker agrees with any pose.
  std::optional<PoseEstimate> track();

  /// All that was found, wherever it hangs.
  std::vector<MarkerObservation> seen() const;

  /// Other poses, from markers that the pose of track() does not explain.
  const std::vector<PoseEstimate>& alternatives() const { return alternatives_; }

 private:
  /// This many markers make a prediction sharp enough to find all others easily.
  static constexpr std::size_t kToStart = 2;
  /// m: with this deviation of the pose, markers may be farther off in the image than where they
  /// are looked for.
  static constexpr double kVague = 0.01;

  /// What became of a predicted marker.
  struct Sighting {
    std::optional<MarkerObservation> observation;
    /// Where its pattern was looked for, once its place was known well enough.
    std::optional<PredictedMarker> looked_at;
    bool was_decoded = false;
    /// From MarkerMemory: whether it was seen before, or is probably hidden and not looked for.
    bool is_likely = false;
    bool is_hidden = false;
    /// Whether it hangs elsewhere than the map says.
    bool is_elsewhere = false;
  };
  /// A reading that is none of the predicted markers, and why it is not accepted.
  struct Stranger {
    MarkerReading reading;
    std::string reason;
  };

  void remember();
  /// Looks for the patterns of the markers that were not found, the likeliest first, until this
  /// many are found.
  void recognize(const PoseEstimate& belief, std::size_t enough);
  /// Looks for the patterns of all others and solves again; once more if the first solution left
  /// their places too uncertain.
  void findOthers();
  /// Looks for the patterns of all that were not found, or only of the likely ones; true if it
  /// found one.
  bool recognizeAll(const PoseEstimate& belief, bool are_only_likely);
  /// Looks for the pattern of one near its projection from a pose, if its place is known well
  /// enough.
  void recognizeOne(std::size_t target, const PoseEstimate& belief);
  /// Decodes views of the likeliest, one after another, until two markers are found.
  void decodeAnchors();
  /// Decodes those views of these markers that have at most this many pixels.
  void decode(const std::vector<std::size_t>& targets,
              double max_pixels = std::numeric_limits<double>::infinity());
  /// The markers that were not found yet and are not hidden, the likely ones first, then
  /// the largest.
  std::vector<std::size_t> missing() const;
  /// The missing ones that the decoder might still read.
  std::vector<std::size_t> undecoded() const;
  /// The undecoded ones whose patterns could not be looked for.
  std::vector<std::size_t> undecided() const;
  /// How many are found or not hidden.
  std::size_t expected() const;
  std::size_t found() const;
  /// Whether markers may well be elsewhere than at their likeliest places.
  bool isHardlyKnown() const;
  /// Whether the solution is so far off the prediction that other markers may be where the
  /// prediction puts them.
  bool isSurprising() const;
  /// If a marker or two leave the pose vague: looks for the others from poses along the direction
  /// in which it is vaguest. A pattern that may be anywhere within many pixels must match better
  /// than a blurred one can; from nearly the right pose, a few pixels are enough. Takes the others
  /// from the pose that shows most of them, at least two, solves, and looks for the rest.
  void lookAlong();
  /// Looks for the others where they were predicted, with the decoder, too.
  void lookWherePredicted();
  /// Whether the solution is off the prediction, or leaves out some that were found, and too few
  /// agree with it sharply to be sure that they hang in their places.
  bool isDoubtful() const;
  /// Looks again, from a pose, for the patterns of all markers or only of those that do not agree
  /// sharply with the solution, far around and however slanted they are, and solves again: markers
  /// that were recognized from a wrong pose are drawn a little toward that pose. If that finds
  /// more, also looks for the others again. Keeps the old state if no pose agrees then.
  void lookAgain(const Pose& pose, bool are_all);
  bool recognizes() const { return tools_.config.estimation.kind == EstimatorKind::kPhotometric; }
  PoseModel poseModel() const { return tools_.config.motion.pose_model; }
  /// The prior of a robot that was pushed as far as a person may push it.
  PosePrior farthestPushed() const;
  /// What remains of the prior once markers gave the pose without it. If they contradict it, the
  /// prior is widened by several times the apparent motion, because something moved the robot.
  PosePrior afterPush(const PoseEstimate& alone) const;
  /// Estimates the pose from what was found. If markers agree that the robot is elsewhere than
  /// predicted, something moved it that the prediction does not include: from then on, the
  /// prediction counts less.
  void solve();
  std::optional<PoseSolution> solutionOfObserved(const PosePrior& prior);
  /// The observations of `observed_`.
  std::vector<MarkerObservation> observations() const;
  /// If all that was found hangs elsewhere: looks for the others from the pose that the markers of
  /// a group with a known motion give, and solves.
  void findOthersBesideMoved();
  /// If markers lead to another pose than the prediction or other markers do: keeps to the
  /// prediction or the others, and notes the pose.
  void settleConflicts();
  void settleWithPrediction();
  void settleAmongMarkers();
  /// Leaves out markers that hung elsewhere in earlier images, unless the others or, without
  /// others, the prediction show them in their places.
  void leaveOutKnown();
  /// Whether a marker hangs elsewhere according to a solution: beside its place, or nearer to where
  /// a moved group would put it. `was_known`: whether it was already known to hang elsewhere.
  bool isDisplaced(const MarkerObservation& observation, const PoseSolution& solution,
                   const std::vector<Eigen::Isometry3d>& motions, bool was_known) const;
  /// Whether a marker known to hang elsewhere is in its place according to the prior, and not where
  /// a moved group would put it.
  bool mayBeInPlace(const MarkerObservation& observation,
                    const std::vector<Eigen::Isometry3d>& motions) const;
  bool agreesWithPrior(const MarkerObservation& observation, const PosePrior& prior) const;
  /// Standard deviations (Misfit): the most that a marker in its place is off.
  double mostInPlace() const;
  /// Notes the pose that these give by themselves, if they give one.
  void noteAlternative(const std::vector<MarkerObservation>& observations);
  void leaveOut(const std::vector<std::size_t>& targets);
  /// Aligns the solution with the pixels of its markers, leaving out those that are then off; keeps
  /// the pose from corners if others are off without them.
  void align();
  std::vector<std::size_t> usedEntries() const;
  std::optional<PhotometricFit> alignedWith(const std::vector<std::size_t>& entries);
  /// If the pixels of markers disagree about the pose by more than chance: continues with those
  /// that agree, and notes the pose of the others. `prior`: as it was before the disagreement
  /// widened it.
  bool leaveOutDisagreeing(const PhotometricFit& fit, const PosePrior& prior);
  /// The same for markers whose corners are off the pose that the pixels of others give. `misfits`:
  /// of the observations at that pose.
  bool leaveOutFar(const PhotometricFit& fit, const std::vector<Misfit>& misfits);
  /// Takes an aligned pose, unless corners disagree with it.
  bool take(const PhotometricFit& fit, std::vector<Misfit> misfits);
  void report();
  void reportMissed();
  void addViews();
  /// Views around these predicted markers, each naming its targets.
  std::vector<View> viewsOf(const std::vector<std::size_t>& targets) const;

  const TrackingTools& tools_;
  const Frame& frame_;
  const MountedCamera& camera_;
  const PoseEstimate& predicted_;
  bool has_prior_;
  /// What is known of the pose besides what is found, and whether it is less than the prediction
  /// says because something moved the robot.
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
