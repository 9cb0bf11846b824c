#include "omnitag/localization/relocalization_config.h"

#include "common/yaml_reader.h"

namespace omnitag {

RelocalizationConfig readRelocalizationConfig(const YamlReader& reader) {
  reader.refuseReplaced("corner_noise", "estimation/poor_corner_noise");
  reader.refuseReplaced("max_residual_of_one",
                        "relocalization/max_misfit_of_one (standard deviations)");
  reader.allowOnly({"min_lead", "max_misfit_of_one", "max_hamming_of_one", "max_deviation_of_one"});
  RelocalizationConfig config;
  reader.read("min_lead", &config.min_lead, kNonNegative);
  reader.read("max_misfit_of_one", &config.max_misfit_of_one, kPositive);
  reader.read("max_deviation_of_one", &config.max_deviation_of_one, kPositive);
  reader.read("max_hamming_of_one", &config.max_hamming_of_one, {0, 3});
  return config;
}

}  // namespace omnitag
