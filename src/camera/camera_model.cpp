#include "omnitag/camera/camera_model.h"

#include <cmath>

namespace omnitag {

std::optional<Eigen::Vector2d> CameraModel::pixelFromPoint(
    const Eigen::Vector3d& point, Eigen::Matrix<double, 2, 3>* jacobian) const {
  const double distance = std::hypot(point.x(), point.y());
  const std::optional<RadialImage> image = imageFromPoint(distance, point.z());
  if (!image) return std::nullopt;

  // On the axis the azimuth is undefined and any will do: the image is its centre.
  const Eigen::Vector2d radial =
      distance > 0.0 ? Eigen::Vector2d(point.head<2>() / distance) : Eigen::Vector2d::UnitX();
  const Eigen::Vector2d ideal = image->radius * radial;
  if (jacobian == nullptr) {
    const Eigen::Vector2d pixel = image_plane_.pixelFromIdeal(ideal);
    return isInImage(pixel) ? std::optional(pixel) : std::nullopt;
  }

  Eigen::Matrix2d pixel_by_ideal;
  const Eigen::Vector2d pixel = image_plane_.pixelFromIdeal(ideal, &pixel_by_ideal);
  if (!isInImage(pixel)) return std::nullopt;
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
  if (!isInImage(pixel)) return std::nullopt;
  const std::optional<Eigen::Vector2d> ideal = image_plane_.idealFromPixel(pixel);
  if (!ideal) return std::nullopt;
  const double radius = ideal->norm();
  const std::optional<MeridionalRay> ray = rayFromRadius(radius);
  if (!ray) return std::nullopt;
  const Eigen::Vector2d radial =
      radius > 0.0 ? Eigen::Vector2d(*ideal / radius) : Eigen::Vector2d::UnitX();
  const auto inSpace = [&radial](const Eigen::Vector2d& meridional) {
    return Eigen::Vector3d(meridional.x() * radial.x(), meridional.x() * radial.y(),
                           meridional.y());
  };
  return Ray{inSpace(ray->origin), inSpace(ray->direction)};
}

bool CameraModel::isInImage(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.x() <= image_size_.width - 0.5 && pixel.y() >= -0.5 &&
         pixel.y() <= image_size_.height - 0.5;
}

}  // namespace omnitag
