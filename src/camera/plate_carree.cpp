#include "camera/plate_carree.h"

#include <cmath>

namespace omnitag {

Eigen::Vector2d plateCarreeFromAzimuthal(const Eigen::Vector2d& azimuthal,
                                         Eigen::Matrix2d* jacobian) {
  const double angle = azimuthal.norm();
  const Eigen::Vector2d radial =
      angle > 0.0 ? Eigen::Vector2d(azimuthal / angle) : Eigen::Vector2d::UnitX();
  const double across = std::sin(angle);
  const double along = std::cos(angle);
  const double x = across * radial.x();
  const double y = across * radial.y();
  const double from_pole = std::hypot(x, along);
  if (jacobian != nullptr) {
    // Derivatives of the direction: along the meridian through the axis, and across it.
    const double shrink = angle > 0.0 ? across / angle : 1.0;
    const Eigen::Vector2d tangential(-radial.y(), radial.x());
    const Eigen::Matrix2d across_by_azimuthal =
        along * radial * radial.transpose() + shrink * tangential * tangential.transpose();
    const Eigen::RowVector2d along_by_azimuthal = -across * radial.transpose();
    jacobian->row(0) =
        (along * across_by_azimuthal.row(0) - x * along_by_azimuthal) / (from_pole * from_pole);
    jacobian->row(1) = across_by_azimuthal.row(1) / from_pole;
  }
  return {std::atan2(x, along), std::atan2(y, from_pole)};
}

Eigen::Vector2d azimuthalFromPlateCarree(const Eigen::Vector2d& plate_carree) {
  const double from_pole = std::cos(plate_carree.y());
  const Eigen::Vector2d across(from_pole * std::sin(plate_carree.x()), std::sin(plate_carree.y()));
  const double along = from_pole * std::cos(plate_carree.x());
  const double length = across.norm();
  return length > 0.0 ? Eigen::Vector2d(std::atan2(length, along) / length * across)
                      : Eigen::Vector2d::Zero();
}

}  // namespace omnitag
