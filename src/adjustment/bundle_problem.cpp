#include "adjustment/bundle_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adjustment/ceres_options.h"
#include "common/least_deviation.h"

namespace omnitag {
namespace {

/// Standard deviation of a guessed camera parameter, in scales.
constexpr double kScalesOfGuess = 4.0;

/// The rotation vector of a rotation.
Eigen::Vector3d turnOf(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

}  // namespace

BundleProblem::BundleProblem(const Bundle& bundle, const BundleConfig& config)
    : bundle_(bundle),
      config_(config),
      cameras_(*bundle.model, bundle.values, config.free),
      offsets_(Eigen::VectorXd::Zero(cameras_.size())),
      problem_(notOwning()) {
  poses_.reserve(bundle.frames.size());
  for (const Bundle::Frame& frame : bundle.frames) poses_.push_back(blockOf(frame.map_from_base));
  for (const Bundle::Landmark& landmark : bundle.landmarks) {
    MarkerBlocks blocks{landmark.marker, {}, landmark.marker.size};
    if (landmark.prior && !landmark.prior->isExact()) {
      const Eigen::Isometry3d& place = landmark.marker.map_from_marker;
      const Eigen::Isometry3d& known = landmark.prior->map_from_marker;
      blocks.about.map_from_marker = known;
      Eigen::Map<MarkerIncrement>(blocks.increment.data())
          << place.translation() - known.translation(),
          turnOf(place.linear() * known.linear().transpose());
    }
    markers_.push_back(std::move(blocks));
  }
  addObservations();
  addPriorsOfMarkers();
  addPriorsOfPoses();
  addPriorOfCamera();
  addConstraints();
  hold();
}

double* BundleProblem::estimated(double* block) {
  const bool is_there = problem_.HasParameterBlock(block);
  return is_there && !problem_.IsParameterBlockConstant(block) ? block : nullptr;
}

template <typename Cost>
ceres::ResidualBlockId BundleProblem::add(std::unique_ptr<Cost> cost, ceres::LossFunction* loss,
                                          const std::vector<double*>& blocks) {
  costs_.push_back(std::move(cost));
  return problem_.AddResidualBlock(costs_.back().get(), loss, blocks);
}

void BundleProblem::addObservations() {
  for (const Bundle::Observation& observation : bundle_.observations) {
    MarkerBlocks& marker = markers_[observation.landmark];
    std::vector<double*> blocks = {poses_[observation.frame].data(), marker.increment.data(),
                                   &marker.size};
    if (offsets_.size() > 0) blocks.push_back(offsets_.data());
    observations_.push_back(add(
        std::make_unique<MarkerCost>(&cameras_, bundle_.frames[observation.frame].base_from_camera,
                                     marker.about, observation, config_.noise),
        &marker_loss_, blocks));
  }
}

void BundleProblem::addPriorsOfMarkers() {
  for (std::size_t i = 0; i < markers_.size(); ++i) {
    const auto& prior = bundle_.landmarks[i].prior;
    double* block = markers_[i].increment.data();
    if (!prior || prior->isExact() || !problem_.HasParameterBlock(block)) continue;
    std::vector<KnownNumbersCost::Known> known;
    bool is_soft = true;
    for (int k = 0; k < 6; ++k) {
      const double deviation = prior->deviations(k);
      if (!std::isfinite(deviation)) continue;
      known.push_back({k, 0.0, std::max(deviation, kLeastDeviation)});
      is_soft = is_soft && deviation > kLeastDeviation;
    }
    // Priors that define where the map is have no robust loss.
    others_.push_back(add(std::make_unique<KnownNumbersCost>(6, std::move(known)),
                          is_soft ? &place_loss_ : nullptr, {block}));
  }
}

void BundleProblem::addPriorsOfPoses() {
  for (const Bundle::Motion& motion : bundle_.motions) {
    others_.push_back(add(std::make_unique<MotionCost>(motion, config_.is_free), nullptr,
                          {poses_[motion.from].data(), poses_[motion.to].data()}));
  }
  if (config_.is_free) return;
  constexpr int kZ = 3;
  const double height = std::max(config_.height_deviation, kLeastDeviation);
  const double lean = std::max(config_.lean_deviation, kLeastDeviation);
  for (SixBlock& pose : poses_) {
    if (!problem_.HasParameterBlock(pose.data())) continue;
    const std::vector<KnownNumbersCost::Known> standing = {
        {kZ, 0.0, height}, {kZ + 1, 0.0, lean}, {kZ + 2, 0.0, lean}};
    others_.push_back(add(std::make_unique<KnownNumbersCost>(6, standing), nullptr, {pose.data()}));
  }
}

void BundleProblem::addPriorOfCamera() {
  if (offsets_.size() == 0) return;
  std::vector<KnownNumbersCost::Known> guess;
  for (std::size_t i = 0; i < config_.free.size(); ++i) {
    const Eigen::Index index = config_.free[i];
    const CalibrationParameter& parameter =
        bundle_.model->parameters()[static_cast<std::size_t>(index)];
    const double offset = (parameter.value - bundle_.values(index)) / parameter.scale;
    guess.push_back({static_cast<int>(i), offset, kScalesOfGuess});
  }
  add(std::make_unique<KnownNumbersCost>(static_cast<int>(offsets_.size()), std::move(guess)),
      nullptr, {offsets_.data()});
}

void BundleProblem::addConstraints() {
  for (const PlaceConstraint& constraint : bundle_.constraints) {
    std::vector<Marker> about;
    std::vector<double*> blocks;
    for (const std::size_t landmark : constraint.markers) {
      about.push_back(markers_[landmark].about);
      blocks.push_back(markers_[landmark].increment.data());
    }
    others_.push_back(
        add(std::make_unique<ConstraintCost>(constraint, std::move(about)), &number_loss_, blocks));
  }
}

void BundleProblem::hold() {
  const auto holdBlock = [this](double* block) {
    if (problem_.HasParameterBlock(block)) problem_.SetParameterBlockConstant(block);
  };
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    if (bundle_.frames[i].is_held || !config_.adjusts_poses) holdBlock(poses_[i].data());
  }
  for (std::size_t i = 0; i < markers_.size(); ++i) {
    const auto& prior = bundle_.landmarks[i].prior;
    const bool is_exact = prior && prior->isExact();
    if (is_exact || !config_.adjusts_markers) holdBlock(markers_[i].increment.data());
    if (!config_.estimates_sizes || bundle_.landmarks[i].knows_size) holdBlock(&markers_[i].size);
  }
}

std::vector<double*> BundleProblem::independentPoses() {
  std::vector<bool> is_tied(poses_.size(), false);
  std::vector<std::vector<std::size_t>> neighbours(poses_.size());
  for (const Bundle::Motion& motion : bundle_.motions) {
    neighbours[motion.from].push_back(motion.to);
    neighbours[motion.to].push_back(motion.from);
  }
  std::vector<double*> blocks;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    double* block = poseBlock(i);
    if (is_tied[i] || block == nullptr) continue;
    blocks.push_back(block);
    for (const std::size_t neighbour : neighbours[i]) is_tied[neighbour] = true;
  }
  return blocks;
}

void BundleProblem::store(Bundle* bundle) const {
  bundle->values = cameras_.valuesAt(offsets_);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    bundle->frames[i].map_from_base = poseOfBlock(poses_[i].data());
  }
  for (std::size_t i = 0; i < markers_.size(); ++i) {
    Marker& marker = bundle->landmarks[i].marker;
    const Marker now = markerAt(markers_[i].about, markers_[i].increment.data(), markers_[i].size);
    const auto& prior = bundle->landmarks[i].prior;
    if (!prior || !prior->isExact()) marker.map_from_marker = now.map_from_marker;
    marker.size = now.size;
  }
}

}  // namespace omnitag
