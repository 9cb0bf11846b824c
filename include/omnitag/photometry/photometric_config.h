#pragma once

namespace omnitag {

/// How a pose is aligned with the grey levels of the panorama.
struct PhotometricConfig {
  /// Lower bound of the noise in grey levels: grey levels are rounded, and no pattern is printed
  /// and lit as evenly as in the model.
  double min_noise = 1.0;
  /// Pixels of the panorama: standard deviation of the error that all of a marker's pixels have in
  /// common, since neither the camera model nor the pattern's is perfect.
  double alignment_deviation = 0.0015;
  /// Upper limits on the pixels at edges of modules, of all markers together: until the pose is
  /// nearly right, and for the last step from there. More pixels in the last step make the pose
  /// more exact. Regardless of these limits, up to 75 pixels of each marker are used.
  int max_pixels = 600;
  int max_final_pixels = 12000;
};

}  // namespace omnitag
