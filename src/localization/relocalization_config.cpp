#include "omnitag/localization/relocalization_config.h"

namespace omnitag {

RelocalizationConfig readRelocalizationConfig(const YamlReader& reader) {
  reader.allowOnly({"corner_noise", "min_lead", "max_residual_of_one", "max_hamming_of_one",
                    "max_deviation_of_one"});
  RelocalizationConfig config;
  reader.read("corner_noise", &config.corner_noise, kPositive);
  reader.read("min_lead", &config.min_lead, kNonNegative);
  reader.read("max_residual_of_one", &config.max_residual_of_one, kPositive);
  reader.read("max_deviation_of_one", &config.max_deviation_of_one, kPositive);
  reader.read("max_hamming_of_one", &config.max_hamming_of_one, {0, 3});
  return config;
}

}  // namespace omnitag
