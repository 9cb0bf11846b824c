#include "perturbed_cameras.h"

#include <cmath>
#include <utility>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// In scales. The projection is exact to the machine's precision, so that little is lost.
constexpr double kStep = 1e-4;

Eigen::Vector3d inCamera(const MountedCamera& camera, const Eigen::Vector3d& in_base) {
  const Eigen::Isometry3d& base_from_camera = camera.baseFromCamera();
  return base_from_camera.linear().transpose() * (in_base - base_from_camera.translation());
}

}  // namespace

PerturbedCameras::PerturbedCameras(const CalibrationModel& model, Eigen::VectorXd start,
                                   std::vector<Eigen::Index> free)
    : model_(model), start_(std::move(start)), free_(std::move(free)) {}

Eigen::VectorXd PerturbedCameras::valuesAt(const double* offsets) const {
  Eigen::VectorXd values = start_;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    values(free_[i]) += offsets[i] * model_.parameters()[static_cast<std::size_t>(free_[i])].scale;
  }
  return values;
}

bool PerturbedCameras::moveTo(const double* offsets, bool with_derivatives) {
  const Eigen::VectorXd wanted =
      size() > 0 ? Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(offsets, size()))
                 : Eigen::VectorXd();
  const bool is_there = camera_ && offsets_ == wanted;
  if (is_there && (!with_derivatives || pairs_.size() == free_.size())) return true;
  const Eigen::VectorXd values = valuesAt(offsets);
  if (!values.allFinite()) return false;
  if (!is_there) {
    pairs_.clear();
    camera_.reset();
    try {
      camera_.emplace(model_.mounted(values));
    } catch (const InputError&) {
      return false;
    }
    offsets_ = wanted;
  }
  return !with_derivatives || makeDerivatives(values);
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
      pairs_.push_back({model_.mounted(larger), model_.mounted(smaller)});
    }
  } catch (const InputError&) {
    pairs_.clear();
    return false;
  }
  return true;
}

std::optional<Eigen::Vector2d> PerturbedCameras::project(
    const Pose& map_from_base, const Eigen::Vector3d& point, Eigen::Matrix2Xd* by_offsets,
    Eigen::Matrix<double, 2, 3>* by_pose) const {
  const double c = std::cos(map_from_base.yaw);
  const double s = std::sin(map_from_base.yaw);
  const double dx = point.x() - map_from_base.x;
  const double dy = point.y() - map_from_base.y;
  const Eigen::Vector3d in_base(c * dx + s * dy, c * dy - s * dx, point.z());
  Eigen::Matrix<double, 2, 3> by_point;
  std::optional<Eigen::Vector2d> pixel = camera_->model().pixelBeyondImage(
      inCamera(*camera_, in_base), by_pose == nullptr ? nullptr : &by_point);
  if (!pixel) return std::nullopt;
  if (by_pose != nullptr) {
    Eigen::Matrix3d in_base_by_pose;
    in_base_by_pose << -c, -s, in_base.y(), s, -c, -in_base.x(), 0.0, 0.0, 0.0;
    *by_pose = by_point * camera_->baseFromCamera().linear().transpose() * in_base_by_pose;
  }
  if (by_offsets != nullptr) {
    by_offsets->setZero(2, size());
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const Pair& pair = pairs_[i];
      const auto larger = pair.larger.model().pixelBeyondImage(inCamera(pair.larger, in_base));
      const auto smaller = pair.smaller.model().pixelBeyondImage(inCamera(pair.smaller, in_base));
      if (!larger || !smaller) continue;
      by_offsets->col(static_cast<Eigen::Index>(i)) = (*larger - *smaller) / (2.0 * kStep);
    }
  }
  return pixel;
}

}  // namespace omnitag
