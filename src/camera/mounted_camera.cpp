#include "camera/mounted_camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/rotation.h"

namespace omnitag {

MountedCamera::MountedCamera(std::shared_ptr<const CameraModel> camera,
                             const Eigen::Isometry3d& base_from_camera)
    : camera_(std::move(camera)),
      base_from_camera_(base_from_camera),
      camera_from_base_(base_from_camera.inverse()) {}

MountedCamera MountedCamera::withError(const ImagingError& error) const {
  MountedCamera camera = *this;
  camera.motion_.velocity.head<3>() += motion_.deviations.cwiseProduct((error - error_).tail<3>());
  camera.error_ = error;
  camera.has_camera_error_ = !error.head<kCameraModes>().isZero(0.0);
  return camera;
}

MountedCamera MountedCamera::withMotion(const ShutterConfig& shutter,
                                        const BaseMotion& motion) const {
  MountedCamera camera = *this;
  camera.shutter_ = shutter;
  camera.motion_ = motion;
  camera.motion_.velocity.head<3>() += motion.deviations.cwiseProduct(error_.tail<3>());
  camera.moves_ = shutter.image_time_offset != 0.0 || shutter.row_readout_time != 0.0;
  return camera;
}

MountedCamera MountedCamera::withBlur(const ImageBlur& blur) const {
  MountedCamera camera = *this;
  camera.blur_ = blur;
  return camera;
}

std::optional<Eigen::Vector2d> MountedCamera::pixelFromMap(
    const Eigen::Isometry3d& map_from_base, const Eigen::Vector3d& point, FrameJacobian* by_frame,
    Eigen::Matrix<double, 2, 3>* by_point) const {
  const Eigen::Vector3d at_stamp =
      map_from_base.linear().transpose() * (point - map_from_base.translation());
  const bool wants_derivatives = by_frame != nullptr || by_point != nullptr;
  std::optional<Image> image = imageOf(at_stamp, wants_derivatives);
  if (!image) return std::nullopt;

  if (wants_derivatives) {
    const Eigen::Matrix<double, 2, 3> by_point_in_map =
        image->by_point * map_from_base.linear().transpose();
    if (by_point != nullptr) *by_point = by_point_in_map;
    if (by_frame != nullptr) {
      // A turn of the base turns its points back: at_stamp x rotation.
      const Eigen::Matrix<double, 2, 3> turned = image->by_point * crossMatrix(at_stamp);
      *by_frame << -by_point_in_map.leftCols<2>(), turned.col(2), -by_point_in_map.col(2),
          turned.leftCols<2>(), camera_->displacementByError(image->pixel), image->by_velocities;
    }
  }
  if (has_camera_error_) {
    image->pixel += camera_->displacementByError(image->pixel) * error_.head<kCameraModes>();
  }
  return image->pixel;
}

std::optional<MountedCamera::Image> MountedCamera::imageOf(const Eigen::Vector3d& at_stamp,
                                                           bool wants_derivatives) const {
  Image image;
  if (!moves_) {
    const auto pixel = project(at_stamp, wants_derivatives ? &image.by_point : nullptr);
    if (!pixel) return std::nullopt;
    image.pixel = *pixel;
    return image;
  }
  // The time of a neighbouring row hardly changes where the point is.
  constexpr int kRounds = 3;
  double time = shutter_.timeOf(0.5 * camera_->imageSize().height);
  Eigen::Isometry3d motion;
  Eigen::Matrix<double, 2, 3> by_point;
  for (int round = 0; round < kRounds; ++round) {
    motion = motion_.after(time);
    const bool is_last = round == kRounds - 1;
    const auto pixel =
        project(motion.inverse() * at_stamp, is_last && wants_derivatives ? &by_point : nullptr);
    if (!pixel) return std::nullopt;
    image.pixel = *pixel;
    if (!is_last) time = shutter_.timeOf(pixel->y());
  }
  if (!wants_derivatives) return image;

  // A point that is displaced to another row is also seen earlier or later.
  const Eigen::Vector3d then = motion.inverse() * at_stamp;
  const Eigen::Vector3d velocity =
      translationPart(motion_.velocity) + rotationPart(motion_.velocity).cross(then);
  Eigen::Matrix2d later = Eigen::Matrix2d::Identity();
  later.col(1) += shutter_.row_readout_time * (by_point * velocity);
  by_point = later.inverse() * by_point;
  image.by_point = by_point * motion.linear().transpose();
  // A velocity displaces the base along the direction at the middle of its turn.
  Eigen::Matrix3d by_velocities;
  by_velocities << rotationOf(-0.5 * time * rotationPart(motion_.velocity)).leftCols<2>(),
      Eigen::Vector3d::UnitZ().cross(then);
  image.by_velocities = -time * by_point * by_velocities * motion_.deviations.asDiagonal();
  return image;
}

std::optional<Eigen::Vector2d> MountedCamera::project(const Eigen::Vector3d& in_base,
                                                      Eigen::Matrix<double, 2, 3>* by_point) const {
  std::optional<Eigen::Vector2d> pixel =
      camera_->pixelFromPoint(camera_from_base_ * in_base, by_point);
  if (pixel && by_point != nullptr) *by_point *= camera_from_base_.linear();
  return pixel;
}

std::optional<Ray> MountedCamera::rayInBase(const Eigen::Vector2d& pixel) const {
  const std::optional<Ray> ray = camera_->rayFromPixel(withoutError(pixel));
  return ray ? std::optional(inBase(*ray, pixel)) : std::nullopt;
}

std::optional<Ray> MountedCamera::tabulatedRayInBase(const Eigen::Vector2d& pixel) const {
  const std::optional<Ray> ray = camera_->tabulatedRayFromPixel(withoutError(pixel));
  return ray ? std::optional(inBase(*ray, pixel)) : std::nullopt;
}

Ray MountedCamera::inBase(const Ray& in_camera, const Eigen::Vector2d& pixel) const {
  Ray ray{base_from_camera_ * in_camera.origin, base_from_camera_.linear() * in_camera.direction};
  if (!moves_) return ray;
  const Eigen::Isometry3d motion = motion_.after(shutter_.timeOf(pixel.y()));
  return {motion * ray.origin, motion.linear() * ray.direction};
}

Eigen::Vector2d MountedCamera::withoutError(const Eigen::Vector2d& pixel) const {
  if (!has_camera_error_) return pixel;
  // Errors change so little from pixel to pixel that two rounds are exact to less than
  // a thousandth.
  const auto error = error_.head<kCameraModes>();
  const Eigen::Vector2d about = pixel - camera_->displacementByError(pixel) * error;
  return pixel - camera_->displacementByError(about) * error;
}

Eigen::Matrix<double, 2, 3> MountedCamera::byVelocities(
    const Eigen::Vector2d& pixel, const Eigen::Matrix<double, 2, 6>& by_base) const {
  if (!moves_) return Eigen::Matrix<double, 2, 3>::Zero();
  return shutter_.timeOf(pixel.y()) * by_base.leftCols<3>() * motion_.deviations.asDiagonal();
}

PoseVector MountedCamera::exposedMotion() const {
  PoseVector motion = shutter_.exposure_time * motion_.velocity;
  if (!knowsExposure()) motion[2] = std::sqrt(blur_.turn_square);
  return motion;
}

double MountedCamera::lensVariance(const Eigen::Vector2d& pixel) const {
  if (blur_.rim_variance == 0.0) return blur_.variance;
  const double radius = (pixel - camera_->imagePlane().principalPoint()).norm();
  const double square = std::pow(radius / camera_->rimPixels(), 2);
  return std::max(0.0, blur_.variance + square * blur_.rim_variance);
}

Eigen::Isometry3d MountedCamera::mapFromCamera(const Pose& map_from_base) const {
  return map_from_base.toIsometry() * base_from_camera_;
}

bool MountedCamera::axisUp() const { return base_from_camera_.linear()(2, 2) > 0.0; }

}  // namespace omnitag
