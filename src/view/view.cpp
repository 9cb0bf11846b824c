#include "omnitag/view/view.h"

#include <Eigen/Geometry>
#include <cmath>

namespace omnitag {

double View::azimuthOffset(double column) const {
  const double tangent = (column - 0.5 * (size.width - 1)) / focal_length;
  return std::atan(axis_up ? -tangent : tangent);
}

double View::height(double row) const {
  const double above_middle = (0.5 * (size.height - 1) - row) * distance / focal_length;
  return middle_height + (axis_up ? above_middle : -above_middle);
}

double View::column(double azimuth_offset) const {
  const double tangent = std::tan(azimuth_offset);
  return 0.5 * (size.width - 1) + focal_length * (axis_up ? -tangent : tangent);
}

double View::row(double height) const {
  const double above_middle = axis_up ? height - middle_height : middle_height - height;
  return 0.5 * (size.height - 1) - above_middle * focal_length / distance;
}

Eigen::Matrix3d View::axes() const {
  const Eigen::Vector3d horizontal(std::cos(azimuth), std::sin(azimuth), 0.0);
  const Eigen::Vector3d along = Eigen::Vector3d::UnitZ();
  const double c = std::cos(elevation);
  const double s = std::sin(elevation);
  const Eigen::Vector3d forward = c * horizontal + s * along;
  const Eigen::Vector3d up = (axis_up ? 1.0 : -1.0) * (c * along - s * horizontal);
  Eigen::Matrix3d axes;
  axes << forward.cross(up), up, forward;
  return axes;
}

Eigen::Vector3d View::pointAt(const Eigen::Vector2d& position) const {
  const double right = (position.x() - 0.5 * (size.width - 1)) * distance / focal_length;
  const double up = (axis_up ? 1.0 : -1.0) * height(position.y());
  return axes() * Eigen::Vector3d(right, up, distance);
}

std::optional<Eigen::Vector2d> View::positionOf(const Ray& ray) const {
  const Eigen::Matrix3d from_optical = axes().transpose();
  const Eigen::Vector3d origin = from_optical * ray.origin;
  const Eigen::Vector3d direction = from_optical * ray.direction;
  if (!(direction.z() > 0.0) || !(origin.z() < distance)) return std::nullopt;
  const Eigen::Vector3d point = origin + (distance - origin.z()) / direction.z() * direction;
  return Eigen::Vector2d(0.5 * (size.width - 1) + point.x() * focal_length / distance,
                         row((axis_up ? 1.0 : -1.0) * point.y()));
}

}  // namespace omnitag
