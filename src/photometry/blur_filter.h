#pragma once

#include <Eigen/Core>

#include "omnitag/camera/image_blur.h"
#include "omnitag/photometry/blur_equations.h"

namespace omnitag {

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
