#pragma once

#include <algorithm>

namespace omnitag {

/// How much the markers of an image disagree about its pose: chi-square by what their pixels, the
/// map and the camera say, and its degrees of freedom. None where one marker tells the pose alone.
struct Disagreement {
  double chi_square = 0.0;
  double freedom = 0.0;
};

/// What images have in common of it: blur, a tone curve or a map that is off make all of them
/// disagree by more than chance does, and what one image shows of that is too little to tell.
class LastingDisagreement {
 public:
  /// How many times larger than expected squared errors are, at least 1.
  double excess() const { return std::max(1.0, sum_.chi_square / sum_.freedom); }

  void add(const Disagreement& image) {
    // Some ten images are remembered, and of one with a marker that is hidden or moved, which only
    // that image shows, no more than this many times what is known.
    constexpr double kRemembered = 0.9;
    constexpr double kMost = 8.0;
    const double chi_square = std::min(image.chi_square, kMost * excess() * image.freedom);
    sum_.chi_square = kRemembered * sum_.chi_square + chi_square;
    sum_.freedom = kRemembered * sum_.freedom + image.freedom;
  }

 private:
  /// To begin with, what an image of three markers says that are as expected.
  Disagreement sum_{18.0, 18.0};
};

}  // namespace omnitag
