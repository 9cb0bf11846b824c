#include "omnitag/camera/mounted_camera.h"

#include <utility>

#include "omnitag/common/rotation.h"

namespace omnitag {

MountedCamera::MountedCamera(std::shared_ptr<const CameraModel> camera,
                             const Eigen::Isometry3d& base_from_camera)
    : camera_(std::move(camera)),
      base_from_camera_(base_from_camera),
      camera_from_base_(base_from_camera.inverse()) {}

MountedCamera MountedCamera::withError(const CameraError& error) const {
  MountedCamera camera = *this;
  camera.error_ = error;
  camera.has_error_ = !error.isZero(0.0);
  return camera;
}

std::optional<Eigen::Vector2d> MountedCamera::pixelFromMap(
    const Eigen::Isometry3d& map_from_base, const Eigen::Vector3d& point, FrameJacobian* by_frame,
    Eigen::Matrix<double, 2, 3>* by_point) const {
  const Eigen::Vector3d in_base =
      map_from_base.linear().transpose() * (point - map_from_base.translation());
  const Eigen::Vector3d in_camera = camera_from_base_ * in_base;
  const bool wants_derivatives = by_frame != nullptr || by_point != nullptr;
  Eigen::Matrix<double, 2, 3> by_point_in_camera;
  std::optional<Eigen::Vector2d> pixel =
      camera_->pixelFromPoint(in_camera, wants_derivatives ? &by_point_in_camera : nullptr);
  if (!pixel) return std::nullopt;

  if (wants_derivatives) {
    const Eigen::Matrix<double, 2, 3> by_point_in_base =
        by_point_in_camera * camera_from_base_.linear();
    const Eigen::Matrix<double, 2, 3> by_point_in_map =
        by_point_in_base * map_from_base.linear().transpose();
    if (by_point != nullptr) *by_point = by_point_in_map;
    if (by_frame != nullptr) {
      // What the base turns by, a point of it turns back: in_base x rotation.
      const Eigen::Matrix<double, 2, 3> turned = by_point_in_base * crossMatrix(in_base);
      *by_frame << -by_point_in_map.leftCols<2>(), turned.col(2), -by_point_in_map.col(2),
          turned.leftCols<2>(), camera_->displacementByError(*pixel);
    }
  }
  if (has_error_) *pixel += camera_->displacementByError(*pixel) * error_;
  return pixel;
}

std::optional<Ray> MountedCamera::rayInBase(const Eigen::Vector2d& pixel) const {
  const std::optional<Ray> ray = camera_->rayFromPixel(withoutError(pixel));
  if (!ray) return std::nullopt;
  return Ray{base_from_camera_ * ray->origin, base_from_camera_.linear() * ray->direction};
}

std::optional<Ray> MountedCamera::tabulatedRayInBase(const Eigen::Vector2d& pixel) const {
  const std::optional<Ray> ray = camera_->tabulatedRayFromPixel(withoutError(pixel));
  if (!ray) return std::nullopt;
  return Ray{base_from_camera_ * ray->origin, base_from_camera_.linear() * ray->direction};
}

Eigen::Vector2d MountedCamera::withoutError(const Eigen::Vector2d& pixel) const {
  if (!has_error_) return pixel;
  // Errors change so little from pixel to pixel that two rounds leave less than a thousandth.
  const Eigen::Vector2d about = pixel - camera_->displacementByError(pixel) * error_;
  return pixel - camera_->displacementByError(about) * error_;
}

Eigen::Isometry3d MountedCamera::mapFromCamera(const Pose& map_from_base) const {
  return map_from_base.toIsometry() * base_from_camera_;
}

bool MountedCamera::axisUp() const { return base_from_camera_.linear()(2, 2) > 0.0; }

}  // namespace omnitag
