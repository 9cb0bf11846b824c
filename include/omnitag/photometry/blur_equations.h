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

/// Learns the blur from image to image: the lens's part, which hardly changes, and the turn during
/// the exposure, which differs from image to image.
class BlurFilter {
 public:
  /// `variance`: first guess of the lens's blur, in pixels squared.
  explicit BlurFilter(double variance) { blur_.variance = variance; }

  /// The blur expected of the next image.
  const ImageBlur& blur() const { return blur_; }

  /// The blur of an image that was predicted with blur `predicted`.
  ImageBlur after(const BlurEquations& image, const ImageBlur& predicted) const;

  /// Learns from an image; the arguments are those of after().
  void take(const BlurEquations& image, const ImageBlur& predicted);

 private:
  BlurVector changeBy(const BlurEquations& image, const ImageBlur& predicted) const;

  ImageBlur blur_;
  /// Of variance and rim_variance.
  Eigen::Matrix2d information_ = Eigen::Matrix2d::Identity();
};

/// Whether two blurs differ so little that results for one hold for the other. `rim`: radius of the
/// visible part of the image, in pixels.
bool areAlike(const ImageBlur& a, const ImageBlur& b, double rim);

}  // namespace omnitag
