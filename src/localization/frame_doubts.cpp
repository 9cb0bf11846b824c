#include <algorithm>
#include <utility>

#include "common/parallel.h"
#include "common/stopwatch.h"
#include "common/symmetric_matrix.h"
#include "localization/frame_tracker.h"
#include "photometry/recognition.h"

namespace omnitag {

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
