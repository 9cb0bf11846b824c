#pragma once

#include <algorithm>
#include <vector>

namespace omnitag {

/// Noise of grey levels: constant on even ground and larger at edges, as if these were randomly
/// displaced from pixel to pixel. Neither sensors nor prints produce edges exactly as a pixel's
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
  /// Change from pixel to pixel of the share of white, and of the grey level.
  double gradient = 0.0;
  double grey_gradient = 0.0;
};

/// Whether a pixel is, or should be, so bright or dark that its grey level may be clipped.
inline bool isSaturated(double grey, double expected) {
  constexpr double kDarkest = 3.0;
  constexpr double kBrightest = 250.0;
  return std::max(grey, expected) > kBrightest || std::min(grey, expected) < kDarkest;
}

/// 1 / variance; less for pixels that are off by more than 3.5 deviations.
inline double weightOf(const PixelResidual& residual, const PixelNoise& noise) {
  constexpr double kOutlier = 3.5;
  const double variance = noise.variance(residual.grey_gradient);
  const double limit = kOutlier * kOutlier * variance;
  const double square = residual.grey * residual.grey;
  return square <= limit ? 1.0 / variance : limit / (variance * square);
}

/// Estimates the noise on even ground and at edges. There must be at least one residual.
/// `least_flat`: lower bound of the noise, in grey levels.
PixelNoise noiseOf(std::vector<PixelResidual> residuals, double least_flat);

}  // namespace omnitag
