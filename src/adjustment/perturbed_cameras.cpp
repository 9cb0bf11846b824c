#include "adjustment/perturbed_cameras.h"

#include <utility>

#include "common/rotation.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// In scales; this small because the projection is exact to machine precision.
constexpr double kStep = 1e-4;

}  // namespace

Eigen::Vector3d PerturbedCameras::Variant::inCamera(const Eigen::Isometry3d& base_from_camera,
                                                    const Eigen::Vector3d& in_base) const {
  const Eigen::Vector3d in_guessed =
      mounting_change.linear().transpose() * (in_base - mounting_change.translation());
  return base_from_camera.linear().transpose() * (in_guessed - base_from_camera.translation());
}

PerturbedCameras::PerturbedCameras(const CalibrationModel& model, Eigen::VectorXd start,
                                   std::vector<Eigen::Index> free)
    : model_(model), start_(std::move(start)), free_(std::move(free)) {}

Eigen::VectorXd PerturbedCameras::valuesAt(const Eigen::VectorXd& offsets) const {
  Eigen::VectorXd values = start_;
  for (Eigen::Index i = 0; i < size(); ++i) {
    const Eigen::Index index = free_[static_cast<std::size_t>(i)];
    values(index) += offsets(i) * model_.parameters()[static_cast<std::size_t>(index)].scale;
  }
  return values;
}

bool PerturbedCameras::moveTo(const double* offsets, bool with_derivatives) {
  const Eigen::VectorXd wanted =
      size() > 0 ? Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(offsets, size()))
                 : Eigen::VectorXd();
  const bool is_there = middle_ && offsets_ == wanted;
  if (is_there && (!with_derivatives || pairs_.size() == free_.size())) return true;

  const Eigen::VectorXd values = valuesAt(wanted);
  if (!values.allFinite()) return false;
  if (!is_there) {
    pairs_.clear();
    middle_.reset();
    try {
      middle_ = Variant{model_.cameraAt(values), model_.mountingChange(values)};
    } catch (const InputError&) {
      return false;
    }
    offsets_ = wanted;
  }
  return !with_derivatives || makeDerivatives(values);
}

PerturbedCameras::Variant PerturbedCameras::variantAt(const Eigen::VectorXd& values,
                                                      Eigen::Index changed) const {
  if (model_.isOfMounting(changed)) return {nullptr, model_.mountingChange(values)};
  return {model_.cameraAt(values), middle_->mounting_change};
}

bool PerturbedCameras::makeDerivatives(const Eigen::VectorXd& values) {
  pairs_.clear();
  try {
    for (const Eigen::Index index : free_) {
      const double step = kStep * model_.parameters()[static_cast<std::size_t>(index)].scale;
      Eigen::VectorXd larger = values;
      Eigen::VectorXd smaller = values;
      larger(index) += step;
      smaller(index) -= step;
      pairs_.push_back({variantAt(larger, index), variantAt(smaller, index)});
    }
  } catch (const InputError&) {
    pairs_.clear();
    return false;
  }
  return true;
}

Eigen::Matrix2Xd PerturbedCameras::byOffsets(
    const Eigen::Isometry3d& base_from_camera, const Eigen::Vector3d& in_base,
    const Eigen::Matrix<double, 2, 3>& by_point_in_camera) const {
  Eigen::Matrix2Xd by_offsets = Eigen::Matrix2Xd::Zero(2, size());
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto& [larger, smaller] = pairs_[i];
    const Eigen::Vector3d in_larger = larger.inCamera(base_from_camera, in_base);
    const Eigen::Vector3d in_smaller = smaller.inCamera(base_from_camera, in_base);
    Eigen::Vector2d change;
    if (!larger.camera) {
      change = by_point_in_camera * (in_larger - in_smaller);
    } else {
      const auto a = larger.camera->pixelBeyondImage(in_larger);
      const auto b = smaller.camera->pixelBeyondImage(in_smaller);
      if (!a || !b) continue;
      change = *a - *b;
    }
    by_offsets.col(static_cast<Eigen::Index>(i)) = change / (2.0 * kStep);
  }
  return by_offsets;
}

std::optional<Eigen::Vector2d> PerturbedCameras::project(const Eigen::Isometry3d& map_from_base,
                                                         const Eigen::Isometry3d& base_from_camera,
                                                         const Eigen::Vector3d& point,
                                                         PixelDerivatives* derivatives) const {
  const Eigen::Vector3d in_base =
      map_from_base.linear().transpose() * (point - map_from_base.translation());
  const Eigen::Vector3d in_camera = middle_->inCamera(base_from_camera, in_base);
  Eigen::Matrix<double, 2, 3> by_point_in_camera;
  std::optional<Eigen::Vector2d> pixel = middle_->camera->pixelBeyondImage(
      in_camera, derivatives == nullptr ? nullptr : &by_point_in_camera);
  if (!pixel || derivatives == nullptr) return pixel;

  const Eigen::Matrix<double, 2, 3> by_point_in_base =
      by_point_in_camera * base_from_camera.linear().transpose() *
      middle_->mounting_change.linear().transpose();
  derivatives->by_point = by_point_in_base * map_from_base.linear().transpose();
  // As the base turns, a point turns the other way in it.
  const Eigen::Matrix<double, 2, 3> turned = by_point_in_base * crossMatrix(in_base);
  derivatives->by_pose << -derivatives->by_point.leftCols<2>(), turned.col(2),
      -derivatives->by_point.col(2), turned.leftCols<2>();
  derivatives->by_offsets = byOffsets(base_from_camera, in_base, by_point_in_camera);
  return pixel;
}

}  // namespace omnitag
