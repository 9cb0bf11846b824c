#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "common/symmetric_matrix.h"
#include "localization/frame_tracker.h"
#include "measurement/consensus.h"

namespace omnitag {
namespace {

/// m and rad: nobody pushes a robot farther between two images.
constexpr double kFarthestPush = 0.3;

/// How many of a PoseVector's numbers change if something moves the robot: a robot on a floor stays
/// on it.
int numbersOfPush(PoseModel model) { return model == PoseModel::kFloor ? 3 : 6; }

/// A push by this much (m and rad) along and about each of the axes.
PoseVector anyPush(double way, double turn, PoseModel model) {
  PoseVector push = poseVector(Eigen::Vector3d::Constant(way), Eigen::Vector3d::Constant(turn));
  push.tail(push.size() - numbersOfPush(model)).setZero();
  return push;
}

/// Whether so few markers disagree so much that any of them may have been moved. Where more markers
/// disagree, the camera more likely is off its file, and the pose stands (group_study).
bool mayAnyBeMoved(const PhotometricFit& fit) {
  constexpr std::size_t kFew = 3;
  constexpr double kMostSurprise = 3.0;
  return fit.markers.size() <= kFew && fit.surprise > kMostSurprise;
}

}  // namespace

PosePrior FrameTracker::farthestPushed() const {
  return prior_.pushed(anyPush(kFarthestPush, kFarthestPush, poseModel()));
}

PosePrior FrameTracker::afterPush(const PoseEstimate& alone) const {
  // Chi-square with 3 or 6 degrees of freedom, exceeded once in ten thousand.
  const double limit = poseModel() == PoseModel::kFloor ? 21.1 : 27.9;
  constexpr double kTimes = 3.0;
  const int count = numbersOfPush(poseModel());
  PoseVector apart = prior_.errorOf(alone.pose);
  apart.tail(apart.size() - count).setZero();
  const PoseMatrix covariance = prior_.covariance() + alone.covariance;
  if (mahalanobisSquare(apart.head(count), covariance.topLeftCorner(count, count)) <= limit) {
    return prior_;
  }
  return prior_.pushed(anyPush(kTimes * translationPart(apart).norm(),
                               kTimes * rotationPart(apart).norm(), poseModel()));
}

void FrameTracker::align() {
  // Markers whose corners or pixels are off are left out, and the rest are aligned again.
  constexpr int kRounds = 3;
  const std::size_t all = usedEntries().size();
  for (int round = 0; round < kRounds && solution_; ++round) {
    const std::vector<std::size_t> entries = usedEntries();
    // If many are off, the rest are no likelier to hang in their places than those.
    const bool is_rest_small = !has_prior_ && !isLargeMajority(entries.size(), all);
    if (entries.empty() || is_rest_small) break;
    const PosePrior before = prior_;
    const std::optional<PhotometricFit> fit = alignedWith(entries);
    if (!fit) break;
    if (!has_prior_ && mayAnyBeMoved(*fit)) {
      solution_.reset();
      return;
    }
    if (leaveOutDisagreeing(*fit, before)) continue;
    std::vector<Misfit> misfits =
        misfitsAt(tools_.map, camera_, observations(), fit->map_from_base.pose, fit->imaging_error,
                  tools_.config.estimation.reprojection);
    if (leaveOutFar(*fit, misfits)) continue;
    if (take(*fit, std::move(misfits))) return;
  }
  if (!solution_) return;
  solution_->map_from_base = standingOnCorners(solution_->map_from_base, all, tools_.config);
}

std::vector<std::size_t> FrameTracker::usedEntries() const {
  std::vector<std::size_t> entries;
  for (std::size_t k = 0; k < observed_.size(); ++k) {
    if (!solution_->used[k]) continue;
    entries.push_back(sightings_[observed_[k]].observation->map_entry);
  }
  return entries;
}

std::optional<PhotometricFit> FrameTracker::alignedWith(const std::vector<std::size_t>& entries) {
  const auto from = [&](const Pose& start, const PosePrior& prior) {
    return alignWithPixels(tools_, frame_.image, camera_, entries, start, prior);
  };
  auto aligned = from(solution_->map_from_base.pose, prior_);
  if (!aligned || !has_prior_ || entries.size() < 2 || aligned->surprise <= 1.0) return aligned;
  // Pixels show motions that corners are too coarse for.
  const auto alone = from(aligned->map_from_base.pose, farthestPushed());
  if (!alone) return aligned;
  prior_ = afterPush(alone->map_from_base);
  return from(alone->map_from_base.pose, prior_);
}

bool FrameTracker::leaveOutDisagreeing(const PhotometricFit& fit, const PosePrior& prior) {
  if (!has_prior_ || fit.surprise <= 1.0 || fit.markers.size() < 2) return false;
  const Pose& pose = fit.map_from_base.pose;
  const PosePrior pushed = farthestPushed();
  std::vector<bool> agree =
      consensusOf(fit.markers, pushed, pose, fit.imaging_error, tools_.lasting_excess);
  if (std::find(agree.begin(), agree.end(), false) == agree.end()) return false;
  std::vector<bool> others = agree;
  others.flip();
  if (const auto other = poseOf(fit.markers, others, pushed, pose, fit.imaging_error)) {
    alternatives_.push_back(*other);
  }
  // The prior was only widened because the markers disagree.
  prior_ = prior;
  std::vector<std::size_t> disagreeing;
  for (std::size_t k = 0, i = 0; k < observed_.size(); ++k) {
    if (solution_->used[k] && others[i++]) disagreeing.push_back(observed_[k]);
  }
  leaveOut(disagreeing);
  return true;
}

bool FrameTracker::leaveOutFar(const PhotometricFit& fit, const std::vector<Misfit>& misfits) {
  // Pixels that show something else hardly pull; then the corners decide.
  if (!has_prior_ || sharplyAgreeing(misfits) == 0) return false;
  std::vector<std::size_t> far;
  std::vector<MarkerObservation> rest;
  for (std::size_t k = 0, i = 0; k < misfits.size(); ++k) {
    if (!solution_->used[k]) continue;
    constexpr double kHardly = 0.5;
    const bool pulls = fit.markers[i] && fit.weights[i] > kHardly;
    ++i;
    if (pulls || misfits[k].deviations <= mostInPlace()) continue;
    far.push_back(observed_[k]);
    rest.push_back(*sightings_[observed_[k]].observation);
  }
  if (far.empty()) return false;
  noteAlternative(rest);
  leaveOut(far);
  return true;
}

bool FrameTracker::take(const PhotometricFit& fit, std::vector<Misfit> misfits) {
  bool are_all_near = true;
  std::vector<bool> used = solution_->used;
  for (std::size_t k = 0; k < misfits.size(); ++k) {
    const bool is_near = misfits[k].deviations <= tools_.config.estimation.max_misfit;
    are_all_near = are_all_near && (is_near || !used[k]);
    used[k] = used[k] && is_near;
  }
  if (!are_all_near) {
    solution_->used = std::move(used);
    return false;
  }
  result_->blur_equations = fit.blur;
  result_->disagreement = fit.disagreement;
  *solution_ = {fit.map_from_base, fit.imaging_error, std::move(misfits), std::move(used),
                fit.excess};
  return true;
}

}  // namespace omnitag
