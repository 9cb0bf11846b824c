#pragma once

#include <Eigen/Core>

#include "omnitag/camera/image_blur.h"

namespace omnitag {

/// The unknowns of an ImageBlur, in its order: variance, rim_variance, turn_square.
using BlurVector = Eigen::Vector3d;
using BlurMatrix = Eigen::Matrix3d;

/// Normal equations of least squares for an image's blur, linearised at the blur that its pixels
/// were predicted with. The light on each marker is free.
struct BlurEquations {
  BlurMatrix information = BlurMatrix::Zero();
  /// The information times the change that the pixels ask for.
  BlurVector gradient = BlurVector::Zero();

  void add(const BlurEquations& other) {
    information += other.information;
    gradient += other.gradient;
  }
};

}  // namespace omnitag
