#include "omnitag/localization/estimator_config.h"

#include "common/yaml_reader.h"

namespace omnitag {

EstimatorConfig readEstimatorConfig(const YamlReader& reader) {
  reader.refuseReplaced("max_residual", "estimation/max_misfit (standard deviations)");
  reader.refuseReplaced("robust_width", "estimation/robust_misfit (standard deviations)");
  reader.refuseReplaced("placement_deviation", "deviation in the map file");
  reader.allowOnly({"corner_noise", "poor_corner_noise", "robust_misfit", "max_misfit", "blur",
                    "min_noise", "alignment_deviation", "max_pixels", "max_final_pixels"});
  EstimatorConfig config;
  reader.read("corner_noise", &config.reprojection.corner_noise, kPositive);
  reader.read("poor_corner_noise", &config.reprojection.poor_corner_noise, kPositive);
  reader.read("robust_misfit", &config.reprojection.robust_misfit, kPositive);
  reader.read("max_misfit", &config.max_misfit, kPositive);
  reader.read("blur", &config.blur, {0.0, 5.0});
  reader.read("min_noise", &config.photometric.min_noise, kPositive);
  reader.read("alignment_deviation", &config.photometric.alignment_deviation, kNonNegative);
  reader.read("max_pixels", &config.photometric.max_pixels, {50, 1000000});
  reader.read("max_final_pixels", &config.photometric.max_final_pixels, {50, 1000000});
  return config;
}

}  // namespace omnitag
