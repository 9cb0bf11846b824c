#pragma once

#include "omnitag/common/yaml_reader.h"

namespace omnitag {

/// When a pose that was found without any prediction is believed.
struct RelocalizationConfig {
  /// Pixels of the panorama: standard deviation of a corner when hypotheses are compared. Larger
  /// than what corners have on average, since a small or blurred marker must not decide by chance.
  double corner_noise = 0.15;
  /// Log-likelihood by which the best of several poses that explain the same markers must lead.
  double min_lead = 10.0;
  /// Pixels, RMS over the corners of the only marker that a pose explains.
  double max_residual_of_one = 0.5;
  /// Corrected bits of the only marker that a pose explains.
  int max_hamming_of_one = 1;
  /// m: standard deviation of a pose's position that a single marker may leave.
  double max_deviation_of_one = 0.2;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
RelocalizationConfig readRelocalizationConfig(const YamlReader& reader);

}  // namespace omnitag
