#include "omnitag/camera/camera_model.h"

#include <algorithm>
#include <cmath>

namespace omnitag {
namespace {

/// The ray in space, in the half-plane through the axis that contains a point of the ideal
/// image plane.
Ray inSpace(const MeridionalRay& ray, const Eigen::Vector2d& ideal, double radius) {
  const Eigen::Vector2d radial =
      radius > 0.0 ? Eigen::Vector2d(ideal / radius) : Eigen::Vector2d::UnitX();
  return {{ray.origin.x() * radial.x(), ray.origin.x() * radial.y(), ray.origin.y()},
          {ray.direction.x() * radial.x(), ray.direction.x() * radial.y(), ray.direction.y()}};
}

/// The factor by which an image's size differs from a camera's; nothing if it is neither an integer
/// nor the inverse of one.
std::optional<double> factorOf(const ImageSize& camera, const ImageSize& image) {
  if (image.width < 1 || image.height < 1) return std::nullopt;
  const int times = image.width / camera.width;
  if (times >= 1 && image.width == times * camera.width && image.height == times * camera.height) {
    return times;
  }
  const int part = camera.width / image.width;
  if (part >= 1 && camera.width / part == image.width && camera.height / part == image.height) {
    return 1.0 / part;
  }
  return std::nullopt;
}

}  // namespace

std::shared_ptr<const CameraModel> CameraModel::ofImage(const ImageSize& size) const {
  const std::optional<double> factor =
      scales_to_image_ ? factorOf(image_size_, size) : std::optional(1.0);
  if (!factor) return nullptr;
  std::shared_ptr<CameraModel> camera = copy();
  if (*factor == 1.0) return camera;
  camera->image_size_ = size;
  camera->image_plane_ = image_plane_.scaled(*factor);
  camera->uncertainty_ = uncertainty_.scaled(*factor);
  camera->tabulateRays();
  return camera;
}

std::optional<Eigen::Vector2d> CameraModel::pixelFromPoint(
    const Eigen::Vector3d& point, Eigen::Matrix<double, 2, 3>* jacobian) const {
  const std::optional<Eigen::Vector2d> pixel = pixelBeyondImage(point, jacobian);
  return pixel && isInImage(*pixel) ? pixel : std::nullopt;
}

std::optional<Eigen::Vector2d> CameraModel::pixelBeyondImage(
    const Eigen::Vector3d& point, Eigen::Matrix<double, 2, 3>* jacobian) const {
  const double distance = point.head<2>().norm();
  const std::optional<RadialImage> image = imageFromPoint(distance, point.z());
  if (!image) return std::nullopt;

  // On the axis the azimuth is undefined and any will do: the image is its centre.
  const Eigen::Vector2d radial =
      distance > 0.0 ? Eigen::Vector2d(point.head<2>() / distance) : Eigen::Vector2d::UnitX();
  const Eigen::Vector2d ideal = image->radius * radial;
  if (jacobian == nullptr) return image_plane_.pixelFromIdeal(ideal);

  Eigen::Matrix2d pixel_by_ideal;
  const Eigen::Vector2d pixel = image_plane_.pixelFromIdeal(ideal, &pixel_by_ideal);
  const double radius_per_distance =
      distance > 0.0 ? image->radius / distance : image->radius_by_distance;
  const Eigen::Vector2d tangential(-radial.y(), radial.x());
  Eigen::Matrix<double, 2, 3> ideal_by_point;
  ideal_by_point.leftCols<2>() = image->radius_by_distance * radial * radial.transpose() +
                                 radius_per_distance * tangential * tangential.transpose();
  ideal_by_point.col(2) = image->radius_by_height * radial;
  *jacobian = pixel_by_ideal * ideal_by_point;
  return pixel;
}

std::optional<Ray> CameraModel::rayFromPixel(const Eigen::Vector2d& pixel) const {
  const std::optional<Eigen::Vector2d> ideal = idealFromPixel(pixel);
  if (!ideal) return std::nullopt;
  const double radius = ideal->norm();
  const std::optional<MeridionalRay> ray = rayFromRadius(radius);
  return ray ? std::optional(inSpace(*ray, *ideal, radius)) : std::nullopt;
}

std::optional<Ray> CameraModel::tabulatedRayFromPixel(const Eigen::Vector2d& pixel) const {
  const std::optional<Eigen::Vector2d> ideal = idealFromPixel(pixel);
  if (!ideal) return std::nullopt;
  const double radius = ideal->norm();
  const double place = (radius - minRadius()) / radius_step_;
  if (!(place >= 0.0 && place <= static_cast<double>(rays_.size() - 1))) return std::nullopt;
  const std::size_t below = std::min(static_cast<std::size_t>(place), rays_.size() - 2);
  const double share = place - static_cast<double>(below);
  const MeridionalRay& a = rays_[below];
  const MeridionalRay& b = rays_[below + 1];
  return inSpace({(1.0 - share) * a.origin + share * b.origin,
                  (1.0 - share) * a.direction + share * b.direction},
                 *ideal, radius);
}

std::optional<Eigen::Vector2d> CameraModel::idealFromPixel(const Eigen::Vector2d& pixel) const {
  return isInImage(pixel) ? image_plane_.idealFromPixel(pixel) : std::nullopt;
}

Eigen::Matrix<double, 2, kCameraModes> CameraModel::displacementByError(
    const Eigen::Vector2d& pixel) const {
  return omnitag::displacementByError(uncertainty_,
                                      (pixel - image_plane_.principalPoint()) / rimPixels());
}

void CameraModel::tabulateRays() {
  constexpr double kPixels = 0.25;
  const double span = maxRadius() - minRadius();
  const int steps =
      1 + static_cast<int>(std::min(1e5, std::ceil(span * image_plane_.scale() / kPixels)));
  radius_step_ = span / steps;
  rays_.clear();
  for (int i = 0; i <= steps; ++i) {
    // Rounding must not leave the ring.
    const double radius = std::min(minRadius() + i * radius_step_, maxRadius());
    rays_.push_back(*rayFromRadius(radius));
  }
}

bool CameraModel::isInImage(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.x() <= image_size_.width - 0.5 && pixel.y() >= -0.5 &&
         pixel.y() <= image_size_.height - 0.5;
}

}  // namespace omnitag
