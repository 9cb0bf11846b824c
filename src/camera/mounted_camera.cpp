#include "omnitag/camera/mounted_camera.h"

#include <cmath>
#include <utility>

namespace omnitag {

MountedCamera::MountedCamera(std::shared_ptr<const CameraModel> camera,
                             const Eigen::Isometry3d& base_from_camera)
    : camera_(std::move(camera)),
      base_from_camera_(base_from_camera),
      camera_from_base_(base_from_camera.inverse()) {}

std::optional<Eigen::Vector2d> MountedCamera::pixelFromMap(
    const Pose2& map_from_base, const Eigen::Vector3d& point, Eigen::Matrix<double, 2, 3>* by_pose,
    Eigen::Matrix<double, 2, 3>* by_point) const {
  const double c = std::cos(map_from_base.yaw);
  const double s = std::sin(map_from_base.yaw);
  const double dx = point.x() - map_from_base.x;
  const double dy = point.y() - map_from_base.y;
  const Eigen::Vector3d in_base(c * dx + s * dy, c * dy - s * dx, point.z());
  const Eigen::Vector3d in_camera = camera_from_base_ * in_base;
  if (by_pose == nullptr && by_point == nullptr) return camera_->pixelFromPoint(in_camera);

  Eigen::Matrix<double, 2, 3> by_point_in_camera;
  std::optional<Eigen::Vector2d> pixel = camera_->pixelFromPoint(in_camera, &by_point_in_camera);
  if (!pixel) return std::nullopt;
  const Eigen::Matrix<double, 2, 3> by_point_in_base =
      by_point_in_camera * camera_from_base_.linear();
  if (by_pose != nullptr) {
    Eigen::Matrix3d in_base_by_pose;
    in_base_by_pose << -c, -s, in_base.y(), s, -c, -in_base.x(), 0.0, 0.0, 0.0;
    *by_pose = by_point_in_base * in_base_by_pose;
  }
  if (by_point != nullptr) {
    Eigen::Matrix3d base_from_map;
    base_from_map << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
    *by_point = by_point_in_base * base_from_map;
  }
  return pixel;
}

std::optional<Ray> MountedCamera::rayInBase(const Eigen::Vector2d& pixel) const {
  const std::optional<Ray> ray = camera_->rayFromPixel(pixel);
  if (!ray) return std::nullopt;
  return Ray{base_from_camera_ * ray->origin, base_from_camera_.linear() * ray->direction};
}

std::optional<Ray> MountedCamera::tabulatedRayInBase(const Eigen::Vector2d& pixel) const {
  const std::optional<Ray> ray = camera_->tabulatedRayFromPixel(pixel);
  if (!ray) return std::nullopt;
  return Ray{base_from_camera_ * ray->origin, base_from_camera_.linear() * ray->direction};
}

Eigen::Isometry3d MountedCamera::mapFromCamera(const Pose2& map_from_base) const {
  return map_from_base.toIsometry() * base_from_camera_;
}

bool MountedCamera::axisUp() const { return base_from_camera_.linear()(2, 2) > 0.0; }

}  // namespace omnitag
