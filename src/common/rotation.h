#pragma once

#include <Eigen/Core>

namespace omnitag {

/// The matrix [v] for which [v] w = v x w.
Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& v);

/// The rotation by a rotation vector (rad).
Eigen::Matrix3d rotationOf(const Eigen::Vector3d& rotation_vector);

}  // namespace omnitag
