#include "localization/frame_tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/parallel.h"
#include "common/stopwatch.h"
#include "photometry/recognition.h"

namespace omnitag {
namespace {

/// A prior about a starting pose that knows little more than how the robot stands.
PosePrior vague(const Pose& pose, const PosePrior& standing) {
  constexpr double kDeviation = 1.0;  // m and rad
  PosePrior prior = standing.withPlace(pose, Eigen::Matrix3d::Zero());
  prior.information += PoseMatrix::Identity() / (kDeviation * kDeviation);
  return prior;
}

/// Whether a marker is looked for in the same place as before, not much less far around: the
/// farther around, the better the pattern must match.
bool isSameLook(const PredictedMarker& before, const PredictedMarker& now) {
  constexpr double kSamePlace = 0.5;  // pixels
  constexpr double kNearly = 0.7;
  return (now.center - before.center).norm() < kSamePlace &&
         now.tangential_margin > kNearly * before.tangential_margin &&
         now.radial_margin > kNearly * before.radial_margin;
}

}  // namespace

FrameTracker::FrameTracker(const TrackingTools& tools, const Frame& frame,
                           const MountedCamera& camera, const PoseEstimate& predicted,
                           bool has_prior, FrameResult* result)
    : tools_(tools),
      frame_(frame),
      camera_(camera),
      predicted_(predicted),
      has_prior_(has_prior),
      prior_(has_prior ? PosePrior::about(predicted) : vague(predicted.pose, tools.standing)),
      result_(result),
      sightings_(result->predicted.size()) {}

std::optional<PoseEstimate> FrameTracker::track() {
  if (has_prior_) remember();
  if (recognizes()) {
    // With the first ones, the others are easy to find.
    recognize(predicted_, kToStart);
    solve();
    findOthers();
    lookAlong();
    decodeAnchors();
    if (has_prior_ && !solution_) findOthersBesideMoved();
    // A vague prediction may first lead to markers that were moved as one; from their pose, those
    // in their places are not found.
    const bool is_first = solution_ && tools_.memory.countInPlace() == 0;
    if (has_prior_ && is_first && isHardlyKnown()) {
      lookAgain(predicted_.pose, false);
    }
    if (isSurprising()) lookWherePredicted();
    // The markers found first may have been moved as one, and may have drawn those found later with
    // them.
    if (has_prior_ && isDoubtful()) lookAgain(predicted_.pose, true);
    if (isDoubtful()) lookAgain(solution_->map_from_base.pose, true);
  }
  if (const std::vector<std::size_t> rest = undecided(); !rest.empty()) {
    const std::size_t before = found();
    const bool was_vague = !solution_ || positionDeviation(solution_->map_from_base) > kVague;
    decode(rest);
    solve();
    if (recognizes() && was_vague && found() > before) findOthers();
  }
  Stopwatch step;
  settleConflicts();
  if (solution_) align();
  result_->timings.solve += step.lap();
  if (solution_) {
    result_->excess = solution_->excess;
    result_->imaging_error = solution_->imaging_error;
  }
  report();
  reportMissed();
  if (frame_.wants_views) addViews();
  return solution_ ? std::optional(solution_->map_from_base) : std::nullopt;
}

void FrameTracker::takeSeen(const std::vector<MarkerObservation>& seen) {
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    const auto found =
        std::find_if(seen.begin(), seen.end(), [&](const MarkerObservation& observation) {
          return observation.map_entry == result_->predicted[i].map_entry;
        });
    if (found != seen.end()) sightings_[i].observation = *found;
  }
}

std::vector<MarkerObservation> FrameTracker::seen() const {
  std::vector<MarkerObservation> seen;
  for (const Sighting& sighting : sightings_) {
    if (sighting.observation) seen.push_back(*sighting.observation);
  }
  return seen;
}

void FrameTracker::remember() {
  const Eigen::Vector3d viewpoint = camera_.mapFromCamera(predicted_.pose).translation();
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    const std::size_t entry = result_->predicted[i].map_entry;
    sightings_[i].is_likely = tools_.memory.wasSeen(entry);
    sightings_[i].is_hidden = tools_.memory.isHidden(entry, viewpoint, frame_.stamp);
  }
}

void FrameTracker::recognize(const PoseEstimate& belief, std::size_t enough) {
  Stopwatch step;
  for (const std::size_t target : missing()) {
    if (found() >= enough) break;
    recognizeOne(target, belief);
  }
  result_->timings.recognize += step.lap();
}

void FrameTracker::findOthers() {
  if (!solution_) return;
  // The less well a marker's place is known, the longer it takes to look for it in vain.
  if (recognizeAll(solution_->map_from_base, true)) solve();
  constexpr int kRounds = 2;
  for (int round = 0; round < kRounds && solution_; ++round) {
    const PoseEstimate belief = solution_->map_from_base;
    if (!recognizeAll(belief, false)) return;
    solve();
    if (positionDeviation(belief) <= kVague) return;
  }
}

bool FrameTracker::recognizeAll(const PoseEstimate& belief, bool are_only_likely) {
  Stopwatch step;
  const std::size_t before = found();
  std::vector<std::size_t> targets = missing();
  if (are_only_likely) {
    const auto isUnlikely = [this](std::size_t target) { return !sightings_[target].is_likely; };
    targets.erase(std::remove_if(targets.begin(), targets.end(), isUnlikely), targets.end());
  }
  constexpr std::size_t kWorthAThread = 2;
  forEachIndex(targets.size(), tools_.config.threads, kWorthAThread,
               [&](std::size_t i) { recognizeOne(targets[i], belief); });
  result_->timings.recognize += step.lap();
  return found() > before;
}

void FrameTracker::recognizeOne(std::size_t target, const PoseEstimate& belief) {
  const std::size_t entry = result_->predicted[target].map_entry;
  const auto predicted =
      predictMarker(tools_.map, entry, camera_, belief, tools_.config.visibility);
  if (!predicted || !isPlaceKnown(tools_, camera_, *predicted)) return;
  Sighting& sighting = sightings_[target];
  // The same look would fail again.
  if (sighting.looked_at && isSameLook(*sighting.looked_at, *predicted)) return;
  sighting.looked_at = predicted;
  sighting.observation = recognizePredicted(tools_, frame_.image, camera_, belief.pose, *predicted);
}

std::vector<std::size_t> FrameTracker::missing() const {
  std::vector<std::size_t> targets;
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    if (!sightings_[i].observation && !sightings_[i].is_hidden) targets.push_back(i);
  }
  std::stable_sort(targets.begin(), targets.end(), [this](std::size_t a, std::size_t b) {
    if (sightings_[a].is_likely != sightings_[b].is_likely) return sightings_[a].is_likely;
    return meanEdge(result_->predicted[a].corners) > meanEdge(result_->predicted[b].corners);
  });
  return targets;
}

std::vector<std::size_t> FrameTracker::undecoded() const {
  std::vector<std::size_t> targets = missing();
  const auto isHopeless = [this](std::size_t target) {
    return sightings_[target].was_decoded || longestEdge(result_->predicted[target].corners) <
                                                 tools_.config.visibility.min_decodable_edge_pixels;
  };
  targets.erase(std::remove_if(targets.begin(), targets.end(), isHopeless), targets.end());
  return targets;
}

std::vector<std::size_t> FrameTracker::undecided() const {
  if (recognizes() && !has_prior_) return {};
  std::vector<std::size_t> targets = undecoded();
  if (!solution_) return targets;
  const auto isDecided = [this](std::size_t target) {
    return sightings_[target].looked_at.has_value();
  };
  targets.erase(std::remove_if(targets.begin(), targets.end(), isDecided), targets.end());
  return targets;
}

std::size_t FrameTracker::expected() const {
  return static_cast<std::size_t>(std::count_if(
      sightings_.begin(), sightings_.end(),
      [](const Sighting& sighting) { return sighting.observation || !sighting.is_hidden; }));
}

std::size_t FrameTracker::found() const {
  return static_cast<std::size_t>(
      std::count_if(sightings_.begin(), sightings_.end(),
                    [](const Sighting& sighting) { return sighting.observation.has_value(); }));
}

std::optional<PoseSolution> FrameTracker::solutionOfObserved(const PosePrior& prior) {
  observed_.clear();
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    if (sightings_[i].observation && !sightings_[i].is_elsewhere) observed_.push_back(i);
  }
  return estimatePose(tools_.map, camera_, observations(), prior, tools_.config.estimation);
}

std::vector<MarkerObservation> FrameTracker::observations() const {
  std::vector<MarkerObservation> observations;
  observations.reserve(observed_.size());
  for (const std::size_t i : observed_) observations.push_back(*sightings_[i].observation);
  return observations;
}

void FrameTracker::solve() {
  Stopwatch step;
  if (has_prior_) leaveOutKnown();
  solution_ = solutionOfObserved(prior_);
  // Markers and a prior that contradict each other leave large residuals.
  constexpr double kLargeExcess = 2.0;
  if (solution_ && has_prior_ && observed_.size() >= 2 && solution_->excess > kLargeExcess) {
    const auto alone = solutionOfObserved(farthestPushed());
    if (alone && std::count(alone->used.begin(), alone->used.end(), true) >= 2) {
      prior_ = afterPush(alone->map_from_base);
      is_pushed_ = true;
      solution_ = solutionOfObserved(prior_);
    }
  }
  result_->timings.solve += step.lap();
}

}  // namespace omnitag
