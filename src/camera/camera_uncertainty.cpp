#include "omnitag/camera/camera_uncertainty.h"

namespace omnitag {

Eigen::Matrix<double, 2, 6> displacementByError(const CameraUncertainty& uncertainty,
                                                const Eigen::Vector2d& n) {
  Eigen::Matrix<double, 2, 6> displacement;
  displacement << uncertainty.principal_point * Eigen::Matrix2d::Identity(), uncertainty.scale * n,
      uncertainty.tilt * n * n.transpose(), uncertainty.rim * n.squaredNorm() * n;
  return displacement;
}

}  // namespace omnitag
