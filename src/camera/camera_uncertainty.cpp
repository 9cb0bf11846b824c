#include "omnitag/camera/camera_uncertainty.h"

#include <algorithm>

namespace omnitag {

double CameraUncertainty::local() const {
  constexpr double kShare = 0.3;
  return kShare * std::max({principal_point, scale, tilt, rim});
}

Eigen::Matrix<double, 2, kCameraModes> displacementByError(const CameraUncertainty& uncertainty,
                                                           const Eigen::Vector2d& n) {
  Eigen::Matrix<double, 2, kCameraModes> displacement;
  displacement << uncertainty.principal_point * Eigen::Matrix2d::Identity(), uncertainty.scale * n,
      uncertainty.tilt * n * n.transpose(), uncertainty.rim * n.squaredNorm() * n;
  return displacement;
}

Eigen::Matrix<double, 2, kShapeTerms> displacementByShape(const CameraUncertainty& uncertainty,
                                                          const Eigen::Vector2d& place) {
  const double x = place.x();
  const double y = place.y();
  const Eigen::Matrix2d unit = uncertainty.local() * Eigen::Matrix2d::Identity();
  Eigen::Matrix<double, 2, kShapeTerms> displacement;
  displacement << x * unit, y * unit, x * x * unit, x * y * unit, y * y * unit;
  return displacement;
}

}  // namespace omnitag
