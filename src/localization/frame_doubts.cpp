#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "common/parallel.h"
#include "common/stopwatch.h"
#include "common/symmetric_matrix.h"
#include "localization/frame_tracker.h"
#include "photometry/recognition.h"

namespace omnitag {
namespace {

/// Poses that a vague one may be, along the two directions in which it is vaguest, each of them
/// with the covariance that is left; the likeliest first.
std::vector<PoseEstimate> possiblePoses(const PoseEstimate& vague) {
  // m, the usual distance of markers: a turn moves them by so much.
  constexpr double kRange = 3.0;
  // Deviations along the vaguest direction, the smallest first, and along the other.
  constexpr double kStep = 0.5;
  constexpr std::array<double, 9> kAlong = {0.0, -0.5, 0.5, -1.0, 1.0, -1.5, 1.5, -2.0, 2.0};
  constexpr std::array<double, 3> kAside = {-1.0, 0.0, 1.0};
  const PoseVector scale = poseVector(Eigen::Vector3d::Ones(), Eigen::Vector3d::Constant(kRange));
  const EigenPairs pairs = eigenPairs(scale.asDiagonal() * vague.covariance * scale.asDiagonal());
  const auto deviationAlong = [&](Eigen::Index i) -> PoseVector {
    return std::sqrt(std::max(pairs.values(i), 0.0)) * pairs.vectors.col(i).cwiseQuotient(scale);
  };
  const PoseVector along = deviationAlong(5);
  const PoseVector aside = deviationAlong(4);
  PoseMatrix left = vague.covariance;
  left -= (1.0 - 0.25 * kStep * kStep) * along * along.transpose();
  left -= 0.75 * aside * aside.transpose();
  std::vector<PoseEstimate> poses;
  poses.reserve(kAlong.size() * kAside.size());
  for (const double i : kAlong) {
    for (const double k : kAside) poses.push_back({moved(vague.pose, i * along + k * aside), left});
  }
  return poses;
}

}  // namespace

bool FrameTracker::isHardlyKnown() const {
  constexpr double kHardly = 0.05;  // m
  return positionDeviation(predicted_) > kHardly;
}

bool FrameTracker::isSurprising() const {
  if (!solution_ || !has_prior_) return false;
  constexpr double kLimit = 9.0;  // chi-square, 3 degrees of freedom, exceeded once in 30
  const Eigen::Vector3d off = difference(solution_->map_from_base.pose, predicted_.pose).head<3>();
  return mahalanobisSquare(off, floorCovariance(predicted_)) > kLimit;
}

bool FrameTracker::isDoubtful() const {
  if (!solution_) return false;
  const std::size_t agreeing = sharplyAgreeing(solution_->misfits);
  if (isLargeMajority(agreeing, observed_.size())) {
    // Markers that were not found may be hidden. But if the pose is a surprise, or the prediction
    // too vague to tell, they may just as well be where another pose puts them.
    const bool may_be_elsewhere =
        has_prior_ && (isHardlyKnown() || !agree(solution_->map_from_base, predicted_));
    return may_be_elsewhere && !isLargeMajority(agreeing, expected());
  }
  constexpr double kFar = 0.02;  // m and rad
  const bool do_all_agree =
      std::find(solution_->used.begin(), solution_->used.end(), false) == solution_->used.end();
  return !do_all_agree || difference(solution_->map_from_base.pose, predicted_.pose)
                                  .head<3>()
                                  .cwiseAbs()
                                  .maxCoeff() > kFar;
}

void FrameTracker::lookAlong() {
  constexpr std::size_t kMostFound = 2;
  constexpr std::size_t kMostTargets = 5;
  constexpr std::size_t kFewest = 2;
  if (!solution_ || found() > kMostFound) return;
  if (positionDeviation(solution_->map_from_base) <= kVague) return;
  std::vector<std::size_t> targets = missing();
  const bool are_any_known = has_prior_ && tools_.memory.countInPlace() > 0;
  const auto isUnlikely = [&](std::size_t target) {
    return are_any_known && !sightings_[target].is_likely;
  };
  targets.erase(std::remove_if(targets.begin(), targets.end(), isUnlikely), targets.end());
  targets.resize(std::min(targets.size(), kMostTargets));
  if (targets.size() < kFewest) return;

  Stopwatch step;
  std::vector<std::optional<MarkerObservation>> best;
  std::size_t most = kFewest - 1;
  for (const PoseEstimate& belief : possiblePoses(solution_->map_from_base)) {
    std::vector<std::optional<MarkerObservation>> seen;
    seen.reserve(targets.size());
    for (const std::size_t target : targets) {
      seen.push_back(recognizeMarker(tools_, frame_.image, camera_,
                                     result_->predicted[target].map_entry, belief));
    }
    const auto count = static_cast<std::size_t>(
        std::count_if(seen.begin(), seen.end(), [](const auto& each) { return each.has_value(); }));
    if (count <= most) continue;
    most = count;
    best = std::move(seen);
  }
  result_->timings.recognize += step.lap();
  if (best.empty()) return;
  const std::vector<Sighting> sightings_before = sightings_;
  const PosePrior prior_before = prior_;
  const bool was_pushed = is_pushed_;
  for (std::size_t i = 0; i < targets.size(); ++i) sightings_[targets[i]].observation = best[i];
  solve();
  if (solution_ && usedEntries().size() > kFewest) return findOthers();
  sightings_ = sightings_before;
  prior_ = prior_before;
  is_pushed_ = was_pushed;
  solve();
}

void FrameTracker::lookAgain(const Pose& pose, bool are_all) {
  Stopwatch step;
  std::vector<bool> agrees(sightings_.size(), false);
  for (std::size_t k = 0; solution_ && k < observed_.size(); ++k) {
    agrees[observed_[k]] = !are_all && agreesSharply(solution_->misfits[k]);
  }
  const std::vector<Sighting> before = sightings_;
  const std::size_t found_before = found();
  const PoseEstimate belief{pose};
  // Share of the largest margin: looking farther around takes too long.
  constexpr double kShareAround = 0.5;
  constexpr std::size_t kWorthAThread = 2;
  forEachIndex(sightings_.size(), tools_.config.threads, kWorthAThread, [&](std::size_t i) {
    if (agrees[i]) return;
    auto predicted = predictMarker(tools_.map, result_->predicted[i].map_entry, camera_, belief,
                                   tools_.config.visibility);
    if (!predicted) return;
    const TagPattern& pattern = tools_.patterns.of(tools_.map.markers[predicted->map_entry]);
    predicted->tangential_margin = predicted->radial_margin =
        kShareAround * largestMargin(*predicted, pattern, camera_, tools_.config.recognition);
    const auto anew = recognizePredicted(tools_, frame_.image, camera_, pose, *predicted);
    if (anew) sightings_[i].observation = anew;
  });
  result_->timings.recognize += step.lap();
  solve();
  if (found() > found_before) findOthers();
  if (solution_) return;
  sightings_ = before;
  solve();
}

}  // namespace omnitag
