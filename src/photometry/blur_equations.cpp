#include "omnitag/photometry/blur_equations.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "photometry/blur_filter.h"

namespace omnitag {
namespace {

/// Weight of past images with each new one: about ten of them are remembered.
constexpr double kRemembered = 0.9;

BlurVector vectorOf(const ImageBlur& blur) {
  return {blur.variance, blur.rim_variance, blur.turn_square};
}

}  // namespace

BlurVector BlurFilter::changeBy(const BlurEquations& image, const ImageBlur& predicted) const {
  BlurMatrix information = image.information;
  BlurVector gradient = image.gradient;
  information.topLeftCorner<2, 2>() += information_;
  gradient.head<2>() += information_ * (vectorOf(blur_) - vectorOf(predicted)).head<2>();
  // An unobserved turn keeps its predicted value.
  constexpr double kLeast = 1e-9;
  information(2, 2) += kLeast;
  return information.ldlt().solve(gradient);
}

ImageBlur BlurFilter::after(const BlurEquations& image, const ImageBlur& predicted) const {
  const BlurVector blur = vectorOf(predicted) + changeBy(image, predicted);
  ImageBlur after;
  after.variance = std::max(0.0, blur[0]);
  after.rim_variance = std::max(-after.variance, blur[1]);
  // A turn that may be due to chance is none.
  constexpr double kDeviations = 4.0;
  const double deviation = 1.0 / std::sqrt(std::max(image.information(2, 2), 1e-12));
  after.turn_square = blur[2] > kDeviations * deviation ? blur[2] : 0.0;
  return after;
}

void BlurFilter::take(const BlurEquations& image, const ImageBlur& predicted) {
  blur_ = after(image, predicted);
  information_ = kRemembered * information_ + image.information.topLeftCorner<2, 2>();
}

bool areAlike(const ImageBlur& a, const ImageBlur& b, double rim) {
  constexpr double kAlike = 0.08;  // pixels squared
  constexpr double kShare = 0.1;
  const auto differ = [](double x, double y) {
    return std::abs(x - y) > kAlike + kShare * std::max(x, y);
  };
  const auto ofTurn = [rim](const ImageBlur& blur) { return rim * rim * blur.turn_square / 12.0; };
  return !differ(a.variance, b.variance) &&
         !differ(a.variance + a.rim_variance, b.variance + b.rim_variance) &&
         !differ(ofTurn(a), ofTurn(b));
}

}  // namespace omnitag
