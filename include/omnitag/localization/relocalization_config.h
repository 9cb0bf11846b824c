#pragma once

namespace omnitag {

class YamlReader;

/// When to believe a pose that was found without a prediction.
struct RelocalizationConfig {
  /// Lead in log-likelihood that the best of several poses that explain the same markers must have.
  double min_lead = 10.0;
  /// Largest misfit, in standard deviations (Misfit), of the only marker that a pose explains.
  double max_misfit_of_one = 2.4;
  /// Most corrected bits of the only marker that a pose explains.
  int max_hamming_of_one = 1;
  /// m: largest standard deviation of a pose's position, height included, from a single marker.
  double max_deviation_of_one = 0.2;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
RelocalizationConfig readRelocalizationConfig(const YamlReader& reader);

}  // namespace omnitag
