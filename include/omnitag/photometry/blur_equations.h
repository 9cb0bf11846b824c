#pragma once

#include <Eigen/Core>

#include "omnitag/camera/image_blur.h"

namespace omnitag {

/// What is unknown of an ImageBlur, in its order: variance, rim_variance, turn_square.
using BlurVector = Eigen::Vector3d;
using BlurMatrix = Eigen::Matrix3d;

/// What an image's pixels say about its blur, linearised at the blur that they were predicted with:
/// normal equations of least squares. The light on each marker is free.
struct BlurEquations {
  BlurMatrix information = BlurMatrix::Zero();
  /// The information times the change that the pixels ask for.
  BlurVector gradient = BlurVector::Zero();

  void add(const BlurEquations& other) {
    information += other.information;
    gradient += other.gradient;
  }
};

/// Learns the blur from image to image: the lens's, which hardly changes, and the turn during the
/// exposure, which differs from image to image.
class BlurFilter {
 public:
  /// Pixels squared, of the lens, to begin with.
  explicit BlurFilter(double variance) { blur_.variance = variance; }

  /// What the next image is expected to have.
  const ImageBlur& blur() const { return blur_; }

  /// What an image has that was predicted with this blur.
  ImageBlur after(const BlurEquations& image, const ImageBlur& predicted) const;

  /// Takes it.
  void take(const BlurEquations& image, const ImageBlur& predicted);

 private:
  BlurVector changeBy(const BlurEquations& image, const ImageBlur& predicted) const;

  ImageBlur blur_;
  /// Of the lens's part.
  Eigen::Matrix2d information_ = Eigen::Matrix2d::Identity();
};

/// Whether two blurs make so little difference that what one of them gives holds for the other.
/// `rim`: pixels, the radius of what the image shows.
bool areAlike(const ImageBlur& a, const ImageBlur& b, double rim);

}  // namespace omnitag
