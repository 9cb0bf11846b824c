#include "adjustment/bundle_costs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/rotation.h"
#include "omnitag/common/angle.h"

namespace omnitag {
namespace {

/// Residual of a corner that the camera would not see, in pixels.
constexpr double kHidden = 300.0;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Ceres stores row by row, and does not request derivatives by held blocks.
void store(const RowMajor& jacobian, double* rows) {
  if (rows == nullptr) return;
  std::copy_n(jacobian.data(), jacobian.size(), rows);
}

}  // namespace

SixBlock blockOf(const Pose& pose) {
  return {pose.x, pose.y, pose.yaw, pose.z, pose.roll, pose.pitch};
}

Pose poseOfBlock(const double* block) {
  return {block[0], block[1], normalizeAngle(block[2]), block[3], block[4], block[5]};
}

PoseMatrix poseByBlock(const Pose& pose) {
  const double sin_roll = std::sin(pose.roll);
  const double cos_roll = std::cos(pose.roll);
  // The axes about which yaw and pitch turn, in base_link; roll turns about x.
  const Eigen::Vector3d yaw_axis(-std::sin(pose.pitch), std::cos(pose.pitch) * sin_roll,
                                 std::cos(pose.pitch) * cos_roll);
  const Eigen::Vector3d pitch_axis(0.0, cos_roll, -sin_roll);
  PoseMatrix by_block = PoseMatrix::Identity();
  by_block.col(2) = poseVector(Eigen::Vector3d::Zero(), yaw_axis);
  by_block.col(5) = poseVector(Eigen::Vector3d::Zero(), pitch_axis);
  return by_block;
}

Marker markerAt(const Marker& about, const double* increment, double size) {
  Marker marker = about;
  marker.map_from_marker =
      moved(about.map_from_marker, Eigen::Map<const MarkerIncrement>(increment));
  marker.size = size;
  return marker;
}

void ExpectedLoss::Evaluate(double square, double* out) const {
  if (square <= expected_) {
    out[0] = square;
    out[1] = 1.0;
    out[2] = 0.0;
  } else {
    out[0] = expected_ * (1.0 + std::log(square / expected_));
    out[1] = expected_ / square;
    out[2] = -expected_ / (square * square);
  }
}

MarkerCost::MarkerCost(PerturbedCameras* cameras, const Eigen::Isometry3d& base_from_camera,
                       const Marker& about, const Bundle::Observation& observation, double noise)
    : cameras_(cameras),
      base_from_camera_(base_from_camera),
      about_(about),
      observation_(observation),
      noise_(noise) {
  set_num_residuals(8);
  *mutable_parameter_block_sizes() = {6, 6, 1};
  if (cameras->size() > 0) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(cameras->size()));
  }
}

bool MarkerCost::Evaluate(const double* const* parameters, double* residuals,
                          double** jacobians) const {
  const bool has_camera = cameras_->size() > 0;
  const bool by_camera = has_camera && jacobians != nullptr && jacobians[3] != nullptr;
  if (!cameras_->moveTo(has_camera ? parameters[3] : nullptr, by_camera)) return false;
  if (!(parameters[2][0] > 0.0)) return false;

  const Pose pose = poseOfBlock(parameters[0]);
  const Eigen::Isometry3d map_from_base = pose.toIsometry();
  const Marker marker = markerAt(about_, parameters[1], parameters[2][0]);
  const Corners<Eigen::Vector3d> corners = marker.corners();
  CornerPixels off;
  Eigen::Matrix<double, 8, 6> by_pose = Eigen::Matrix<double, 8, 6>::Zero();
  Eigen::Matrix<double, 8, 6> by_marker = Eigen::Matrix<double, 8, 6>::Zero();
  CornerPixels by_size = CornerPixels::Zero();
  Eigen::MatrixXd by_offsets = Eigen::MatrixXd::Zero(8, cameras_->size());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(2 * k);
    PixelDerivatives derivatives;
    const auto pixel = cameras_->project(map_from_base, base_from_camera_, corners[k],
                                         jacobians == nullptr ? nullptr : &derivatives);
    off.segment<2>(row) = pixel ? Eigen::Vector2d(*pixel - observation_.pixels.segment<2>(row))
                                : Eigen::Vector2d(kHidden, 0.0);
    if (!pixel || jacobians == nullptr) continue;
    const Eigen::Vector3d from_center = corners[k] - marker.center();
    by_pose.middleRows<2>(row) = derivatives.by_pose;
    by_marker.block<2, 3>(row, 0) = derivatives.by_point;
    by_marker.block<2, 3>(row, 3) = -derivatives.by_point * crossMatrix(from_center);
    by_size.segment<2>(row) = derivatives.by_point * from_center / marker.size;
    if (by_camera) by_offsets.middleRows<2>(row) = derivatives.by_offsets;
  }
  const Eigen::Matrix<double, 8, 8> whitening = observation_.whitening / noise_;
  Eigen::Map<CornerPixels>(residuals, 8) = whitening * off;
  if (jacobians == nullptr) return true;
  const Eigen::Vector3d turn = Eigen::Map<const MarkerIncrement>(parameters[1]).tail<3>();
  by_marker.rightCols<3>() = by_marker.rightCols<3>() * leftJacobian(turn);
  store(whitening * by_pose * poseByBlock(pose), jacobians[0]);
  store(whitening * by_marker, jacobians[1]);
  store(whitening * by_size, jacobians[2]);
  if (by_camera) store(whitening * by_offsets, jacobians[3]);
  return true;
}

KnownNumbersCost::KnownNumbersCost(int block_size, std::vector<Known> known)
    : size_(block_size), known_(std::move(known)) {
  set_num_residuals(static_cast<int>(known_.size()));
  mutable_parameter_block_sizes()->push_back(block_size);
}

bool KnownNumbersCost::Evaluate(const double* const* parameters, double* residuals,
                                double** jacobians) const {
  RowMajor jacobian = RowMajor::Zero(num_residuals(), size_);
  for (std::size_t i = 0; i < known_.size(); ++i) {
    const Known& known = known_[i];
    residuals[i] = (parameters[0][known.place] - known.value) / known.deviation;
    jacobian(static_cast<Eigen::Index>(i), known.place) = 1.0 / known.deviation;
  }
  if (jacobians != nullptr) store(jacobian, jacobians[0]);
  return true;
}

MotionCost::MotionCost(const Bundle::Motion& motion, bool is_free)
    : motion_(motion), is_free_(is_free) {
  set_num_residuals(is_free ? 6 : 3);
  *mutable_parameter_block_sizes() = {6, 6};
}

Eigen::VectorXd MotionCost::residualOf(const Pose& from, const Pose& to) const {
  if (!is_free_) {
    const Pose moved = inverse(from.onFloor()) * to.onFloor();
    return difference(moved, motion_.from_from_to.onFloor())
        .head<3>()
        .cwiseQuotient(motion_.deviations);
  }
  const Eigen::Vector3d& deviations = motion_.deviations;
  PoseVector all;
  all << deviations, deviations[0], deviations[2], deviations[2];
  return difference(inverse(from) * to, motion_.from_from_to).cwiseQuotient(all);
}

bool MotionCost::Evaluate(const double* const* parameters, double* residuals,
                          double** jacobians) const {
  const auto residualAt = [this](const SixBlock& from, const SixBlock& to) {
    return residualOf(poseOfBlock(from.data()), poseOfBlock(to.data()));
  };
  std::array<SixBlock, 2> blocks{};
  for (std::size_t b = 0; b < 2; ++b) std::copy_n(parameters[b], 6, blocks[b].begin());
  Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) = residualAt(blocks[0], blocks[1]);
  if (jacobians == nullptr) return true;
  constexpr double kStep = 1e-6;  // m and rad
  for (std::size_t b = 0; b < 2; ++b) {
    if (jacobians[b] == nullptr) continue;
    RowMajor jacobian(num_residuals(), 6);
    for (std::size_t i = 0; i < 6; ++i) {
      auto larger = blocks;
      auto smaller = blocks;
      larger[b][i] += kStep;
      smaller[b][i] -= kStep;
      jacobian.col(static_cast<Eigen::Index>(i)) =
          (residualAt(larger[0], larger[1]) - residualAt(smaller[0], smaller[1])) / (2.0 * kStep);
    }
    store(jacobian, jacobians[b]);
  }
  return true;
}

ConstraintCost::ConstraintCost(const PlaceConstraint& constraint, std::vector<Marker> about)
    : constraint_(constraint), about_(std::move(about)), up_(Eigen::Vector3d::UnitZ()) {
  std::vector<Eigen::Isometry3d> places;
  for (const Marker& marker : about_) places.push_back(marker.map_from_marker);
  if (constraint.kind == MapConstraint::Kind::kPlane) up_ = normalOfPlane(places);
  set_num_residuals(static_cast<int>(errorsOf(constraint, places, up_).size()));
  mutable_parameter_block_sizes()->assign(about_.size(), 6);
}

Eigen::VectorXd ConstraintCost::residualAt(const std::vector<MarkerIncrement>& increments) const {
  std::vector<Eigen::Isometry3d> places;
  for (std::size_t i = 0; i < about_.size(); ++i) {
    places.push_back(moved(about_[i].map_from_marker, increments[i]));
  }
  return errorsOf(constraint_, places, up_) / constraint_.deviation;
}

bool ConstraintCost::Evaluate(const double* const* parameters, double* residuals,
                              double** jacobians) const {
  std::vector<MarkerIncrement> increments;
  for (std::size_t i = 0; i < about_.size(); ++i) {
    increments.emplace_back(Eigen::Map<const MarkerIncrement>(parameters[i]));
  }
  Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) = residualAt(increments);
  if (jacobians == nullptr) return true;
  constexpr double kStep = 1e-6;  // m and rad
  for (std::size_t i = 0; i < about_.size(); ++i) {
    if (jacobians[i] == nullptr) continue;
    RowMajor jacobian(num_residuals(), 6);
    for (Eigen::Index k = 0; k < 6; ++k) {
      auto larger = increments;
      auto smaller = increments;
      larger[i](k) += kStep;
      smaller[i](k) -= kStep;
      jacobian.col(k) = (residualAt(larger) - residualAt(smaller)) / (2.0 * kStep);
    }
    store(jacobian, jacobians[i]);
  }
  return true;
}

}  // namespace omnitag
