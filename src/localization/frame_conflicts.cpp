#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "frame_tracker.h"

namespace omnitag {

void FrameTracker::settleConflicts() {
  if (!solution_ || !has_prior_) return;
  if (is_pushed_) settleWithPrediction();
  if (solution_) settleAmongMarkers();
}

void FrameTracker::settleWithPrediction() {
  const PosePrior predicted = PosePrior::about(predicted_);
  std::vector<std::size_t> for_expected;
  std::vector<std::size_t> for_found;
  bool were_all_seen = true;
  for (std::size_t k = 0; k < observed_.size(); ++k) {
    const Sighting& sighting = sightings_[observed_[k]];
    const bool is_expected = agreesWithPrior(tools_, camera_, *sighting.observation, predicted);
    if (is_expected == solution_->used[k]) continue;
    (is_expected ? for_expected : for_found).push_back(observed_[k]);
    were_all_seen = were_all_seen && (is_expected || sighting.is_likely);
  }
  // What moved by less than tells markers apart, or moved all that the image before showed, is the
  // robot.
  if (for_found.empty() || (for_expected.empty() && were_all_seen)) return;
  const Verdict verdict =
      weigh(predicted_.pose, solution_->map_from_base.pose, for_found, for_expected);
  if (verdict == Verdict::kFound) return leaveOut(for_expected);
  result_->is_open = verdict == Verdict::kOpen;
  prior_ = predicted;
  leaveOut(for_found);
}

void FrameTracker::settleAmongMarkers() {
  std::vector<MarkerObservation> rest;
  std::vector<MarkerObservation> all;
  for (std::size_t k = 0; k < observed_.size(); ++k) {
    all.push_back(*sightings_[observed_[k]].observation);
    if (!solution_->used[k]) rest.push_back(all.back());
  }
  if (rest.empty()) return;
  const EstimatorConfig& config = tools_.config.estimation;
  const auto other = estimatePose(tools_.map, camera_, rest, farthestPushed(), config);
  if (!other) return;
  const std::vector<Misfit> misfits = misfitsAt(tools_.map, camera_, all, other->map_from_base.pose,
                                                other->imaging_error, config.reprojection);
  std::vector<std::size_t> for_solution;
  std::vector<std::size_t> for_other;
  for (std::size_t k = 0; k < observed_.size(); ++k) {
    const double here = solution_->misfits[k].deviations;
    const double there = misfits[k].deviations;
    // One that was not moved may seem in its place by chance.
    const bool is_sharp_here = sharplyAgreeing({solution_->misfits[k]}) > 0;
    if (!is_sharp_here && there < std::min(0.5 * here, config.max_misfit)) {
      for_other.push_back(observed_[k]);
    } else if (solution_->used[k]) {
      for_solution.push_back(observed_[k]);
    }
  }
  const Verdict verdict =
      weigh(solution_->map_from_base.pose, other->map_from_base.pose, for_other, for_solution);
  result_->is_open = result_->is_open || verdict == Verdict::kOpen;
  leaveOut(verdict == Verdict::kFound ? for_solution : for_other);
}

Verdict FrameTracker::weigh(const Pose& expected, const Pose& found,
                            const std::vector<std::size_t>& for_found,
                            const std::vector<std::size_t>& for_expected) const {
  const auto entriesOf = [this](const std::vector<std::size_t>& targets) {
    std::vector<std::size_t> entries;
    entries.reserve(targets.size());
    for (const std::size_t target : targets) {
      entries.push_back(result_->predicted[target].map_entry);
    }
    return entries;
  };
  Contradiction contradiction{predicted_.pose,
                              expected,
                              found,
                              entriesOf(for_found),
                              entriesOf(for_expected),
                              {},
                              frame_.odom_from_base.has_value()};
  for (const Sighting& sighting : sightings_) {
    if (sighting.looked_at && !sighting.observation) {
      contradiction.missed.push_back(sighting.looked_at->map_entry);
    }
  }
  return tools_.evidence.weigh(contradiction, tools_.start);
}

void FrameTracker::leaveOut(const std::vector<std::size_t>& targets) {
  if (targets.empty()) return;
  for (const std::size_t target : targets) sightings_[target].is_elsewhere = true;
  solution_ = solutionOfObserved(prior_);
}

}  // namespace omnitag
