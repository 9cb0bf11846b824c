#include "adjustment/map_refinement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "adjustment/bundle_adjustment.h"
#include "adjustment/corner_alignment.h"
#include "adjustment/joint_estimate.h"
#include "adjustment/key_frame.h"
#include "adjustment/marker_estimate.h"
#include "common/symmetric_matrix.h"
#include "localization/reprojection.h"

namespace omnitag {
namespace {

/// m, between the robot's places in two frames.
constexpr double kMinStep = 0.15;
/// m and rad: smallest deviation, which keeps the information finite.
constexpr double kExact = 1e-6;
/// Chi-square with 6 degrees of freedom, exceeded once in a thousand.
constexpr double kFarthest = 22.5;

MarkerIncrement deviationsOf(const Marker& marker) {
  MarkerIncrement deviations;
  deviations << Eigen::Vector3d::Constant(std::max(marker.deviation, kExact)),
      Eigen::Vector3d::Constant(std::max(marker.orientation_deviation, kExact));
  return deviations;
}

bool isSame(const Marker& a, const Marker& b) {
  constexpr double kSame = 1e-5;  // m, and of a rotation matrix: more than a map file's last digit
  return a.family == b.family && a.id == b.id && a.size == b.size &&
         (a.map_from_marker.matrix() - b.map_from_marker.matrix()).isZero(kSame);
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
  const MarkerObservation observation{*detection.map_entry, detection.corners, detection.center};
  const auto alone = refineByReprojection(map, *result.camera, {observation},
                                          result.map_from_base->pose, PosePrior(), {});
  if (!alone) return std::nullopt;
  const Marker& marker = map.markers[*detection.map_entry];
  return alignCorners(frame.image, marker, patterns.of(marker), *result.camera,
                      alone->map_from_base.pose);
}

}  // namespace

MapRefinement::MapRefinement(const CameraModels& cameras, const MarkerMap& map,
                             const MotionModelConfig& motion)
    : camera_count_(cameras.size()), motion_(motion), patterns_(map) {
  setMap(map);
}

MapRefinement::~MapRefinement() = default;
MapRefinement::MapRefinement(MapRefinement&& other) noexcept = default;
MapRefinement& MapRefinement::operator=(MapRefinement&& other) noexcept = default;

void MapRefinement::setMap(const MarkerMap& map) {
  if (!continues(map)) {
    landmarks_.clear();
    places_.clear();
    views_.clear();
    Eigen::VectorXd variances = Eigen::VectorXd::Ones(
        kStandingNumbers + static_cast<Eigen::Index>(camera_count_) * kCameraModes);
    variances.head<kStandingNumbers>() = standingDeviations(motion_.floor).cwiseAbs2();
    joint_ = std::make_unique<JointEstimate>(
        JointEstimate{Eigen::VectorXd::Zero(variances.size()), variances.asDiagonal()});
  }
  for (std::size_t i = landmarks_.size(); i < map.markers.size(); ++i) append(map.markers[i]);
  patterns_.add(map);
  map_ = map;
  updateMap();
}

bool MapRefinement::continues(const MarkerMap& map) const {
  if (!joint_ || map.markers.size() < landmarks_.size()) return false;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const Marker& marker = map.markers[i];
    if (!isSame(marker, landmarks_[i].in_file) && !isSame(marker, map_.markers[i])) return false;
  }
  return true;
}

void MapRefinement::append(const Marker& marker) {
  Landmark landmark;
  landmark.in_file = marker;
  if (marker.deviation > 0.0 || marker.orientation_deviation > 0.0) {
    landmark.increment = joint_->mean.size();
    joint_->append(deviationsOf(marker).cwiseAbs2());
  }
  landmarks_.push_back(std::move(landmark));
}

bool MapRefinement::isUsable(const FrameResult& result) const {
  if (!result.map_from_base || !result.camera || result.is_open) return false;
  const Eigen::Vector3d place = result.map_from_base->pose.toIsometry().translation();
  return std::none_of(places_.begin(), places_.end(), [&](const Pose& other) {
    return (other.toIsometry().translation() - place).norm() < kMinStep;
  });
}

bool MapRefinement::add(const Frame& frame, const FrameResult& result) {
  if (!isUsable(result)) return false;
  const KeyFrame key = keyFrame(frame, result);
  const bool is_any_uncertain =
      std::any_of(key.sights.begin(), key.sights.end(),
                  [this](const auto& sight) { return landmarks_[sight.entry].increment; });
  if (!is_any_uncertain || key.sights.size() < 2) return false;
  places_.push_back(result.map_from_base->pose);
  if (!learnFrom(key, joint_.get())) return false;
  views_.emplace_back();
  for (const KeyFrame::Sight& sight : key.sights) {
    ++landmarks_[sight.entry].sights;
    if (sight.increment) views_.back().push_back(sight.entry);
  }
  updateMap();
  return true;
}

KeyFrame MapRefinement::keyFrame(const Frame& frame, const FrameResult& result) const {
  KeyFrame key{*result.camera, result.map_from_base->pose, {}, std::nullopt, {}, 0};
  key.first_mode = kStandingNumbers + static_cast<Eigen::Index>(frame.camera) * kCameraModes;
  if (motion_.isOnFloor()) key.standing_deviations = standingDeviations(motion_.floor);
  if (frame.odom_from_base) key.lean = *frame.odom_from_base;
  for (const MarkerDetection& detection : result.detections) {
    // Mapping appends markers to the map that are not the file's.
    const bool is_own = detection.map_entry && *detection.map_entry < landmarks_.size();
    if (!detection.accepted || !is_own) continue;
    const auto corners = alignedCorners(frame, result, detection, map_, patterns_);
    if (!corners) continue;
    const Landmark& landmark = landmarks_[*detection.map_entry];
    key.sights.push_back({*detection.map_entry, landmark.in_file, *corners, landmark.increment});
    // Errors that are alike in all images must not be averaged down.
    key.sights.back().corners.covariance *= alikeFactor(landmark.sights);
  }
  return key;
}

void MapRefinement::updateMap() {
  const std::vector<double> covering = coveringFactors();
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    map_.markers[i] = refinedMarker(landmarks_[i], covering[i]);
  }
}

Marker MapRefinement::refinedMarker(const Landmark& landmark, double covering) const {
  Marker marker = landmark.in_file;
  if (!landmark.increment || landmark.sights == 0) return marker;
  const MarkerIncrement increment = joint_->mean.segment<6>(*landmark.increment);
  const MarkerIncrement deviations = deviationsOf(marker);
  // One that seems to hang beyond its prior was moved, or is mistaken for another.
  if (increment.cwiseQuotient(deviations).squaredNorm() > kFarthest) return marker;
  marker.map_from_marker = moved(marker.map_from_marker, increment);
  MarkerEstimate estimate;
  estimate.covariance = covering * blockOf(landmark, landmark);
  marker.deviation = std::min(marker.deviation, estimate.positionDeviation());
  marker.orientation_deviation =
      std::min(marker.orientation_deviation, estimate.orientationDeviation());
  return marker;
}

MarkerCovariance MapRefinement::blockOf(const Landmark& a, const Landmark& b) const {
  return joint_->covariance.block<6, 6>(*a.increment, *b.increment);
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
  std::vector<double> factors(landmarks_.size());
  for (const std::vector<std::size_t>& view : views_) {
    for (const std::size_t a : view) {
      double sum = 0.0;
      for (const std::size_t b : view) {
        double& known = correlations(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
        if (known < 0.0) known = a == b ? 1.0 : correlationOf(a, b);
        sum += known;
      }
      factors[a] = std::max(factors[a], sum);
    }
  }
  return factors;
}

std::vector<RefinedMarker> MapRefinement::refined() const {
  std::vector<RefinedMarker> markers;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const bool is_refined = landmarks_[i].increment && landmarks_[i].sights > 0;
    if (is_refined) markers.push_back({landmarks_[i].in_file, map_.markers[i]});
  }
  return markers;
}

}  // namespace omnitag
