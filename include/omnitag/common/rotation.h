#pragma once

#include <Eigen/Core>

namespace omnitag {

/// [v] with [v] w = v x w.
Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& v);

/// The rotation that a rotation vector stands for (rad).
Eigen::Matrix3d rotationOf(const Eigen::Vector3d& rotation_vector);

}  // namespace omnitag
