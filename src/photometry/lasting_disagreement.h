#pragma once

#include <algorithm>

#include "omnitag/photometry/disagreement.h"

namespace omnitag {

/// The disagreement that lasts from image to image: blur, a tone curve or errors of the map make
/// all images disagree by more than chance does, and a single image shows too little of that to
/// estimate it.
class LastingDisagreement {
 public:
  /// The factor by which squared errors exceed what is expected, at least 1.
  double excess() const { return std::max(1.0, sum_.chi_square / sum_.freedom); }

  void add(const Disagreement& image) {
    // About ten images are remembered. An image in which a marker is hidden or moved disagrees for
    // that image only; it counts at most this many times the known excess.
    constexpr double kRemembered = 0.9;
    constexpr double kMost = 8.0;
    const double chi_square = std::min(image.chi_square, kMost * excess() * image.freedom);
    sum_.chi_square = kRemembered * sum_.chi_square + chi_square;
    sum_.freedom = kRemembered * sum_.freedom + image.freedom;
  }

 private:
  /// To begin with: an image of three markers that are as expected.
  Disagreement sum_{18.0, 18.0};
};

}  // namespace omnitag
