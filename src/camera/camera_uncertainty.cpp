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

}  // namespace omnitag
