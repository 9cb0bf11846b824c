#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "localization/frame_tracker.h"
#include "measurement/consensus.h"

namespace omnitag {
namespace {

/// A prior, moved to the pose from which a moved group would seem to be in its place.
PosePrior movedBy(const Eigen::Isometry3d& motion, PosePrior prior) {
  prior.pose = Pose::fromIsometry(motion * prior.pose.toIsometry());
  return prior;
}

}  // namespace

void FrameTracker::settleConflicts() {
  if (!solution_ || !has_prior_) return;
  if (is_pushed_) settleWithPrediction();
  if (solution_) settleAmongMarkers();
}

void FrameTracker::settleWithPrediction() {
  const PosePrior predicted = PosePrior::about(predicted_);
  bool are_any_expected = false;
  bool were_all_seen = true;
  std::vector<std::size_t> for_found;
  for (std::size_t k = 0; k < observed_.size(); ++k) {
    const Sighting& sighting = sightings_[observed_[k]];
    const bool is_expected = agreesWithPrior(*sighting.observation, predicted);
    if (is_expected == solution_->used[k]) continue;
    if (is_expected) {
      are_any_expected = true;
    } else {
      for_found.push_back(observed_[k]);
      were_all_seen = were_all_seen && sighting.is_likely;
    }
  }
  // If the motion is too small to tell markers apart, or shifts all that the last image showed, it
  // is the robot's.
  if (for_found.empty() || (!are_any_expected && were_all_seen)) return;
  alternatives_.push_back(solution_->map_from_base);
  prior_ = predicted;
  leaveOut(for_found);
}

void FrameTracker::settleAmongMarkers() {
  const auto count = observed_.size();
  const bool are_all_used =
      std::find(solution_->used.begin(), solution_->used.end(), false) == solution_->used.end();
  if (are_all_used && sharplyAgreeing(solution_->misfits) == count) return;
  const EstimatorConfig& config = tools_.config.estimation;
  const std::vector<MarkerObservation> all = observations();
  const Pose& pose = solution_->map_from_base.pose;
  const ImagingError& error = solution_->imaging_error;
  std::vector<bool> agree =
      consensusOf(equationsAt(tools_.map, camera_, all, pose, error, config.reprojection), prior_,
                  pose, error, tools_.lasting_excess);
  if (std::find(agree.begin(), agree.end(), false) == agree.end()) {
    if (tools_.memory.countInPlace() > 0) return;
    // At the start, what the solution does not use contradicts it even if another pose suits all.
    agree = solution_->used;
  }
  std::vector<MarkerObservation> rest;
  std::vector<std::size_t> disagreeing;
  for (std::size_t k = 0; k < count; ++k) {
    if (agree[k]) continue;
    rest.push_back(all[k]);
    disagreeing.push_back(observed_[k]);
  }
  if (rest.empty()) return;
  noteAlternative(rest);
  leaveOut(disagreeing);
}

void FrameTracker::leaveOutKnown() {
  std::vector<Sighting*> seen;
  bool are_known = false;
  bool are_others = false;
  for (Sighting& sighting : sightings_) {
    if (!sighting.observation) continue;
    seen.push_back(&sighting);
    sighting.is_elsewhere = tools_.memory.isElsewhere(sighting.observation->map_entry);
    are_known = are_known || sighting.is_elsewhere;
    are_others = are_others || !sighting.is_elsewhere;
  }
  // The usual case, checked several times a frame.
  if (!tools_.memory.hasElsewhere()) return;
  std::vector<Eigen::Isometry3d> motions;
  for (const DisplacedGroup& group : tools_.memory.displacedGroups()) {
    if (group.motion) motions.push_back(*group.motion);
  }
  if (!are_known && motions.empty()) return;
  const auto others = are_others ? solutionOfObserved(prior_) : std::nullopt;
  for (Sighting* const sighting : seen) {
    const bool was_known = sighting->is_elsewhere;
    sighting->is_elsewhere = others
                                 ? isDisplaced(*sighting->observation, *others, motions, was_known)
                                 : was_known && !mayBeInPlace(*sighting->observation, motions);
  }
}

bool FrameTracker::isDisplaced(const MarkerObservation& observation, const PoseSolution& solution,
                               const std::vector<Eigen::Isometry3d>& motions,
                               bool was_known) const {
  const Pose& pose = solution.map_from_base.pose;
  const auto deviationsAt = [&](const Pose& place) {
    return misfitsAt(tools_.map, camera_, {observation}, place, solution.imaging_error,
                     tools_.config.estimation.reprojection)
        .front()
        .deviations;
  };
  const double in_place = deviationsAt(pose);
  const bool is_off = in_place > mostInPlace();
  if (was_known == is_off) return was_known;
  // A marker that was there must certainly be back; one that newly comes into view must hang where
  // its group does.
  const double limit = was_known ? 2.0 * mostInPlace() : 0.5 * in_place;
  return std::any_of(motions.begin(), motions.end(), [&](const Eigen::Isometry3d& motion) {
    return deviationsAt(Pose::fromIsometry(motion * pose.toIsometry())) < limit;
  });
}

bool FrameTracker::mayBeInPlace(const MarkerObservation& observation,
                                const std::vector<Eigen::Isometry3d>& motions) const {
  if (!agreesWithPrior(observation, prior_)) return false;
  return std::none_of(motions.begin(), motions.end(), [&](const Eigen::Isometry3d& motion) {
    return agreesWithPrior(observation, movedBy(motion, prior_));
  });
}

void FrameTracker::findOthersBesideMoved() {
  // The pose from a single marker does not tell the motion of others well enough.
  if (tools_.memory.countInPlace() < 2) return;
  for (const DisplacedGroup& group : tools_.memory.displacedGroups()) {
    if (!group.motion) continue;
    std::vector<MarkerObservation> seen;
    for (const Sighting& sighting : sightings_) {
      if (!sighting.observation) continue;
      const std::vector<std::size_t>& entries = group.entries;
      if (std::find(entries.begin(), entries.end(), sighting.observation->map_entry) !=
          entries.end()) {
        seen.push_back(*sighting.observation);
      }
    }
    const auto solution = estimatePose(tools_.map, camera_, seen, movedBy(*group.motion, prior_),
                                       tools_.config.estimation);
    if (!solution) continue;
    // The group's motion is known no better than that pose.
    PoseEstimate belief = solution->map_from_base;
    belief.pose = Pose::fromIsometry(group.motion->inverse() * belief.pose.toIsometry());
    belief.covariance *= 2.0;
    if (!recognizeAll(belief, false)) continue;
    solve();
    return findOthers();
  }
}

bool FrameTracker::agreesWithPrior(const MarkerObservation& observation,
                                   const PosePrior& prior) const {
  return omnitag::agreesWithPrior(tools_.map, tools_.config.estimation, camera_, observation,
                                  prior);
}

double FrameTracker::mostInPlace() const {
  return tools_.config.evidence.in_place * std::sqrt(tools_.lasting_excess);
}

void FrameTracker::noteAlternative(const std::vector<MarkerObservation>& observations) {
  const auto other =
      estimatePose(tools_.map, camera_, observations, farthestPushed(), tools_.config.estimation);
  if (other) alternatives_.push_back(other->map_from_base);
}

void FrameTracker::leaveOut(const std::vector<std::size_t>& targets) {
  if (targets.empty()) return;
  for (const std::size_t target : targets) sightings_[target].is_elsewhere = true;
  solution_ = solutionOfObserved(prior_);
}

}  // namespace omnitag
