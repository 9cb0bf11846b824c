#pragma once

namespace omnitag {

/// How corners are weighed and judged.
struct ReprojectionConfig {
  /// Pixels of the panorama, standard deviation of a corner's position along each axis.
  double corner_noise = 0.045;
  /// The same for a small, blurred or shaded marker: decisions based on corners must not depend
  /// on chance.
  double poor_corner_noise = 0.15;
  /// Standard deviations, RMS over a marker's corners, at which its weight has fallen to half
  /// (Cauchy's function).
  double robust_misfit = 4.0;
};

}  // namespace omnitag
