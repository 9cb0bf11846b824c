#include "localization/frame_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/parallel.h"
#include "common/stopwatch.h"
#include "common/symmetric_matrix.h"
#include "marker/marker_association.h"
#include "photometry/recognition.h"
#include "view/view_planner.h"

namespace omnitag {
namespace {

/// This many markers make a prediction sharp enough to find all others easily.
constexpr std::size_t kFirst = 2;

/// At most this many markers are decoded if the prediction is too vague to recognize them.
constexpr std::size_t kAnchors = 4;

/// Pixels: size of the largest view that is decoded.
constexpr double kAnySize = std::numeric_limits<double>::infinity();

/// The same if the prediction is in doubt: decoding must not cost more than a glance.
double largestInDoubt(const cv::Mat& panorama) {
  constexpr double kShareOfSides = 0.25;
  return kShareOfSides * panorama.cols * kShareOfSides * panorama.rows;
}

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

/// Whether markers may well be elsewhere than at their likeliest places.
bool isHardlyKnown(const PoseEstimate& predicted) {
  constexpr double kHardly = 0.05;  // m
  return positionDeviation(predicted) > kHardly;
}

/// m: with this deviation of the pose, markers may be farther off in the image than where they are
/// looked for.
constexpr double kVague = 0.01;

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
    recognize(predicted_, kFirst);
    solve();
    findOthers();
    decodeAnchors();
    if (has_prior_ && !solution_) findOthersBesideMoved();
    // A vague prediction may first lead to markers that were moved as one; from their pose, those
    // in their places are not found.
    const bool is_first = solution_ && tools_.memory.countInPlace() == 0;
    if (has_prior_ && is_first && isHardlyKnown(predicted_)) {
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
    decode(rest, kAnySize);
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

void FrameTracker::decodeAnchors() {
  std::vector<std::size_t> anchors = undecided();
  anchors.resize(std::min(anchors.size(), kAnchors));
  for (const std::size_t anchor : anchors) {
    if (found() >= kFirst) return;
    const std::size_t before = found();
    decode({anchor}, has_prior_ ? kAnySize : largestInDoubt(frame_.image));
    if (found() == before) continue;
    solve();
    findOthers();
  }
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

void FrameTracker::lookWherePredicted() {
  const std::size_t before = found();
  recognizeAll(predicted_, false);
  std::vector<std::size_t> largest = undecoded();
  largest.resize(std::min(largest.size(), kAnchors));
  decode(largest, kAnySize);
  if (found() > before) solve();
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
        has_prior_ && (isHardlyKnown(predicted_) || !agree(solution_->map_from_base, predicted_));
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

void FrameTracker::decode(const std::vector<std::size_t>& targets, double max_pixels) {
  Stopwatch step;
  std::vector<View> views = viewsOf(targets);
  views.erase(
      std::remove_if(views.begin(), views.end(),
                     [max_pixels](const View& view) { return view.size.area() > max_pixels; }),
      views.end());
  for (const View& view : views) {
    for (const std::size_t target : view.targets) sightings_[target].was_decoded = true;
  }
  result_->timings.predict += step.lap();
  // Views overlap: a marker in one of them may have been expected in another, or be visible
  // there, too.
  for (const MarkerReading& reading : readViews(tools_, std::move(views), result_)) {
    const Association association =
        associate(reading, result_->predicted, tools_.map, tools_.config.association);
    if (association.prediction) {
      Sighting& sighting = sightings_[*association.prediction];
      const std::size_t entry = result_->predicted[*association.prediction].map_entry;
      if (!sighting.observation) {
        sighting.observation = {entry, reading.corners, reading.center,
                                0.0,   reading.hamming, reading.margin};
      }
    } else if (std::none_of(strangers_.begin(), strangers_.end(), [&](const Stranger& other) {
                 return areOfOneMarker(other.reading, reading);
               })) {
      strangers_.push_back({reading, association.reason});
    }
  }
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

void FrameTracker::report() {
  for (std::size_t k = 0; k < observed_.size(); ++k) {
    const MarkerObservation& observation = *sightings_[observed_[k]].observation;
    const Marker& marker = tools_.map.markers[observation.map_entry];
    MarkerDetection detection = toDetection(observation, marker);
    detection.accepted = solution_ && solution_->used[k];
    detection.residual =
        solution_ ? solution_->misfits[k].residual : std::numeric_limits<double>::quiet_NaN();
    detection.deviations =
        solution_ ? solution_->misfits[k].deviations : std::numeric_limits<double>::quiet_NaN();
    if (!detection.accepted) {
      detection.reason = solution_ ? "disagrees with the other markers" : "no pose agrees with it";
    }
    result_->detections.push_back(std::move(detection));
  }
  for (const Sighting& sighting : sightings_) {
    if (!sighting.observation || !sighting.is_elsewhere) continue;
    const std::size_t entry = sighting.observation->map_entry;
    MarkerDetection detection = toDetection(*sighting.observation, tools_.map.markers[entry]);
    detection.reason = kElsewhere;
    result_->elsewhere.push_back(entry);
    result_->detections.push_back(std::move(detection));
  }
  for (Stranger& stranger : strangers_) {
    result_->detections.push_back(toDetection(stranger.reading));
    result_->detections.back().reason = std::move(stranger.reason);
  }
}

void FrameTracker::reportMissed() {
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    const Sighting& sighting = sightings_[i];
    if (sighting.observation || !(sighting.looked_at || sighting.was_decoded)) continue;
    result_->missed.push_back(result_->predicted[i].map_entry);
  }
}

void FrameTracker::addViews() {
  std::vector<std::size_t> targets;
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    if (!sightings_[i].was_decoded) targets.push_back(i);
  }
  for (View& view : viewsOf(targets)) {
    result_->view_images.push_back(tools_.reader.warper().warp(frame_.image, view));
    result_->views.push_back(std::move(view));
  }
}

std::vector<View> FrameTracker::viewsOf(const std::vector<std::size_t>& targets) const {
  std::vector<ViewTarget> view_targets;
  view_targets.reserve(targets.size());
  for (const std::size_t target : targets) {
    view_targets.push_back(viewTarget(result_->predicted[target], camera_.model()));
  }
  std::vector<View> views =
      planViews(view_targets, tools_.reader.warper().table(), camera_.model().imagePlane().scale(),
                camera_.axisUp(), tools_.config.view);
  for (View& view : views) {
    for (std::size_t& target : view.targets) target = targets[target];
  }
  return views;
}

}  // namespace omnitag
