#pragma once

#include <algorithm>
#include <vector>

namespace omnitag {

/// How far grey levels are off: noise on even ground, and at edges as much more as if these were
/// displaced by chance from pixel to pixel. No sensor and no print has an edge just as a pixel's
/// average over an ideal pattern does.
struct PixelNoise {
  double flat = 10.0;  // grey levels
  double edge = 0.05;  // pixels

  double variance(double grey_gradient) const {
    return flat * flat + edge * edge * grey_gradient * grey_gradient;
  }
};

/// A pixel's difference from the pattern.
struct PixelResidual {
  double grey = 0.0;
  /// From pixel to pixel: of the share of white, and of the grey levels.
  double gradient = 0.0;
  double grey_gradient = 0.0;
};

/// Whether a pixel is, or should be, so bright or dark that the image does not tell how much so.
inline bool isSaturated(double grey, double expected) {
  constexpr double kDarkest = 3.0;
  constexpr double kBrightest = 250.0;
  return std::max(grey, expected) > kBrightest || std::min(grey, expected) < kDarkest;
}

/// 1 / variance, and less for pixels that are off by more than 3.5 deviations.
inline double weightOf(const PixelResidual& residual, const PixelNoise& noise) {
  constexpr double kOutlier = 3.5;
  const double variance = noise.variance(residual.grey_gradient);
  const double limit = kOutlier * kOutlier * variance;
  const double square = residual.grey * residual.grey;
  return square <= limit ? 1.0 / variance : limit / (variance * square);
}

/// Tells both kinds of noise apart by the pixels on even ground and those on edges. There must be
/// at least one residual. `least_flat`: grey levels, the least that the noise is taken for.
PixelNoise noiseOf(std::vector<PixelResidual> residuals, double least_flat);

}  // namespace omnitag
