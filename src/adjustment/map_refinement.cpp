#include "adjustment/map_refinement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "adjustment/bundle_adjustment.h"
#include "adjustment/corner_alignment.h"
#include "adjustment/marker_estimate.h"
#include "common/least_deviation.h"
#include "common/symmetric_matrix.h"
#include "localization/reprojection.h"
#include "marker/marker_map_writer.h"

namespace omnitag {
namespace {

/// m, between the robot's places in two frames.
constexpr double kMinStep = 0.15;
/// Chi-square with 6 degrees of freedom, exceeded once in a thousand.
constexpr double kFarthest = 22.5;

bool hasDeviations(const Marker& marker) {
  return marker.deviation > 0.0 || marker.orientation_deviation > 0.0;
}

MarkerIncrement deviationsOf(const Marker& marker) {
  return PlacePrior::surveyed(marker).deviations.cwiseMax(kLeastDeviation);
}

/// Whether `saved` may be `now` a few images ago, which the map file then has.
bool isNearly(const Marker& saved, const Marker& now) {
  Marker moved_there = saved;
  moved_there.map_from_marker = now.map_from_marker;
  moved_there.deviation = now.deviation;
  moved_there.orientation_deviation = now.orientation_deviation;
  constexpr double kNearly = 0.25;  // of the deviations
  const auto areClose = [](double a, double b) {
    return std::abs(a - b) <= kNearly * b + kLeastDeviation;
  };
  const Eigen::AngleAxisd turn(saved.map_from_marker.linear() *
                               now.map_from_marker.linear().transpose());
  return isSameEntry(moved_there, now) && areClose(saved.deviation, now.deviation) &&
         areClose(saved.orientation_deviation, now.orientation_deviation) &&
         (saved.center() - now.center()).norm() <= kNearly * now.deviation + kLeastDeviation &&
         std::abs(turn.angle()) <= kNearly * now.orientation_deviation + kLeastDeviation;
}

/// The largest factor by which a matrix stretches a vector.
double norm(const MarkerCovariance& matrix) {
  return std::sqrt(eigenPairs(matrix * matrix.transpose()).values(5));
}

/// The marker's corners located by its pixels. Its place in the map may be several pixels off; the
/// pose by its own corners is not.
std::optional<AlignedCorners> alignedCorners(const Frame& frame, const FrameResult& result,
                                             const MarkerDetection& detection, const MarkerMap& map,
                                             const TagPatterns& patterns) {
  const MountedCamera camera = result.camera->withBlur(result.blur);
  const MarkerObservation observation{*detection.map_entry, detection.corners, detection.center};
  const auto alone =
      refineByReprojection(map, camera, {observation}, result.map_from_base->pose, PosePrior(), {});
  if (!alone) return std::nullopt;
  const Marker& marker = map.markers[*detection.map_entry];
  return alignCorners(frame.image, marker, patterns.of(marker), camera, alone->map_from_base.pose);
}

}  // namespace

MapRefinement::MapRefinement(std::size_t camera_count, const MarkerMap& map,
                             const MotionModelConfig& motion)
    : camera_count_(camera_count), motion_(motion), patterns_(map) {
  setMap(map);
}

void MapRefinement::setMap(const MarkerMap& map) {
  if (!continues(map)) {
    landmarks_.clear();
    places_.clear();
    views_.clear();
    patterns_ = TagPatterns(map);
    joint_ = JointEstimate();
    joint_.append(standingDeviations(motion_.floor).cwiseAbs2());
    joint_.append(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(camera_count_) * kCameraModes));
  }
  patterns_.add(map);
  for (std::size_t i = landmarks_.size(); i < map.markers.size(); ++i) {
    landmarks_.push_back({map.markers[i], {}, std::nullopt, 0});
  }
  for (std::size_t i = 0; i < landmarks_.size(); ++i) landmarks_[i].given = map.markers[i];
  map_ = map;
  updateMap();
}

bool MapRefinement::continues(const MarkerMap& map) const {
  if (landmarks_.empty() || map.markers.size() < landmarks_.size()) return false;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const Marker& marker = map.markers[i];
    const bool is_known = isSameEntry(marker, landmarks_[i].prior) ||
                          isSameEntry(marker, landmarks_[i].given) ||
                          isNearly(marker, map_.markers[i]);
    if (!is_known) return false;
  }
  return true;
}

std::vector<const MarkerDetection*> MapRefinement::usableDetections(
    const FrameResult& result) const {
  // Standard deviations (Misfit): one that is farther off was probably moved.
  constexpr double kMostOff = 3.0;
  std::vector<const MarkerDetection*> usable;
  for (const MarkerDetection& detection : result.detections) {
    // Mapping appends markers to the map that are not the file's.
    const bool is_own = detection.map_entry && *detection.map_entry < landmarks_.size();
    if (detection.accepted && is_own && !(detection.deviations > kMostOff)) {
      usable.push_back(&detection);
    }
  }
  return usable;
}

bool MapRefinement::isUsable(const Frame& frame, const FrameResult& result) const {
  if (!result.map_from_base || !result.camera || result.is_open) return false;
  const std::vector<const MarkerDetection*> detections = usableDetections(result);
  const bool is_any_uncertain =
      std::any_of(detections.begin(), detections.end(), [this](const MarkerDetection* each) {
        return hasDeviations(landmarks_[*each->map_entry].prior);
      });
  if (!is_any_uncertain || detections.size() < 2) return false;
  const Eigen::Vector3d position = result.map_from_base->pose.toIsometry().translation();
  return std::none_of(places_.begin(), places_.end(), [&](const Place& other) {
    return other.camera == frame.camera && (other.position - position).norm() < kMinStep;
  });
}

bool MapRefinement::add(const Frame& frame, const FrameResult& result) {
  if (!isUsable(frame, result)) return false;
  places_.push_back({frame.camera, result.map_from_base->pose.toIsometry().translation()});
  KeyFrame key{*result.camera, result.map_from_base->pose, sightsIn(frame, result), {}, {}, 0};
  if (key.sights.size() < 2) return false;
  key.first_mode = kStandingNumbers + static_cast<Eigen::Index>(frame.camera) * kCameraModes;
  if (motion_.isOnFloor()) key.standing_deviations = standingDeviations(motion_.floor);
  if (frame.odom_from_base) {
    key.lean.roll = frame.odom_from_base->roll;
    key.lean.pitch = frame.odom_from_base->pitch;
  }
  if (!learnFrom(key, &joint_)) return false;
  views_.emplace_back();
  for (const KeyFrame::Sight& sight : key.sights) {
    ++landmarks_[sight.entry].sights;
    if (sight.increment) views_.back().push_back(sight.entry);
  }
  updateMap();
  return true;
}

std::vector<KeyFrame::Sight> MapRefinement::sightsIn(const Frame& frame,
                                                     const FrameResult& result) {
  std::vector<KeyFrame::Sight> sights;
  for (const MarkerDetection* const detection : usableDetections(result)) {
    auto corners = alignedCorners(frame, result, *detection, map_, patterns_);
    if (!corners) continue;
    Landmark& landmark = landmarks_[*detection->map_entry];
    if (!landmark.increment && hasDeviations(landmark.prior)) {
      landmark.increment = joint_.mean.size();
      joint_.append(deviationsOf(landmark.prior).cwiseAbs2());
    }
    // Errors that are alike in all images do not average out: the information of n images is then
    // that of n / alikeFactor(n).
    corners->covariance *= alikeFactor(landmark.sights) * alikeFactor(landmark.sights + 1);
    sights.push_back({*detection->map_entry, landmark.prior, *corners, landmark.increment});
  }
  return sights;
}

void MapRefinement::updateMap() {
  const std::vector<double> covering = coveringFactors();
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    map_.markers[i] = refinedMarker(landmarks_[i], covering[i]);
  }
}

Marker MapRefinement::refinedMarker(const Landmark& landmark, double covering) const {
  Marker marker = landmark.prior;
  if (!landmark.increment || landmark.sights == 0) return marker;
  const MarkerIncrement increment = joint_.mean.segment<6>(*landmark.increment);
  // One that seems to hang beyond its prior was moved, or is mistaken for another.
  const double square = increment.cwiseQuotient(deviationsOf(marker)).squaredNorm();
  MarkerEstimate estimate;
  estimate.covariance = covering * blockOf(landmark, landmark);
  if (!(square <= kFarthest) || !estimate.covariance.allFinite()) return marker;
  marker.map_from_marker = moved(marker.map_from_marker, increment);
  marker.deviation =
      std::min(marker.deviation, std::max(estimate.positionDeviation(), kLeastDeviation));
  marker.orientation_deviation = std::min(
      marker.orientation_deviation, std::max(estimate.orientationDeviation(), kLeastDeviation));
  return marker;
}

MarkerCovariance MapRefinement::blockOf(const Landmark& a, const Landmark& b) const {
  return joint_.covariance.block<6, 6>(*a.increment, *b.increment);
}

std::vector<double> MapRefinement::coveringFactors() const {
  // With R the covariance of markers in units of their own covariances, sum_b |R_ab| is the factor
  // for marker a (Gershgorin's theorem for blocks): the number of markers that err alike.
  std::vector<Eigen::LLT<MarkerCovariance>> units(landmarks_.size());
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    if (landmarks_[i].increment) units[i].compute(blockOf(landmarks_[i], landmarks_[i]));
  }
  const auto correlationOf = [&](std::size_t a, std::size_t b) {
    const MarkerCovariance half = units[a].matrixL().solve(blockOf(landmarks_[a], landmarks_[b]));
    return norm(units[b].matrixL().solve(half.transpose()));
  };
  const auto count = static_cast<Eigen::Index>(landmarks_.size());
  Eigen::MatrixXd correlations = Eigen::MatrixXd::Constant(count, count, -1.0);
  const auto knownCorrelationOf = [&](std::size_t a, std::size_t b) {
    double& known = correlations(static_cast<Eigen::Index>(std::min(a, b)),
                                 static_cast<Eigen::Index>(std::max(a, b)));
    if (known < 0.0) known = correlationOf(a, b);
    return known;
  };
  std::vector<double> factors(landmarks_.size(), 1.0);
  for (const std::vector<std::size_t>& view : views_) {
    for (const std::size_t a : view) {
      double sum = 1.0;
      for (const std::size_t b : view) sum += a == b ? 0.0 : knownCorrelationOf(a, b);
      factors[a] = std::max(factors[a], sum);
    }
  }
  return factors;
}

std::vector<RefinedMarker> MapRefinement::refined() const {
  std::vector<RefinedMarker> markers;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const bool is_refined = landmarks_[i].increment && landmarks_[i].sights > 0;
    if (is_refined) markers.push_back({landmarks_[i].given, map_.markers[i]});
  }
  return markers;
}

}  // namespace omnitag
