#pragma once

#include <algorithm>
#include <cmath>

namespace omnitag {

/// What blurs an image in addition to the averaging over a pixel's area.
struct ImageBlur {
  /// Pixels squared, variance of the lens's blur at the principal point, and how much larger it is
  /// at the rim; it grows with the square of the radius.
  double variance = 0.0;
  double rim_variance = 0.0;
  /// rad squared: square of the angle by which the base turned about its z axis during the
  /// exposure, if the exposure time is not known.
  double turn_square = 0.0;

  /// Pixels, standard deviation of the lens's blur where it is largest.
  double largestDeviation() const {
    return std::sqrt(std::max({0.0, variance, variance + rim_variance}));
  }
};

}  // namespace omnitag
