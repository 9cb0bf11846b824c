#include "omnitag/localization/evidence_config.h"

#include "common/yaml_reader.h"

namespace omnitag {

EvidenceConfig readEvidenceConfig(const YamlReader& reader) {
  reader.allowOnly({"carried", "carried_without_odometry", "misread", "moved", "moved_per_second",
                    "together", "missed", "mistaken_start", "mistaken", "odds", "odds_at_start",
                    "open_deviation", "in_place"});
  constexpr Interval kProbability{1e-30, 1.0};
  EvidenceConfig config;
  reader.read("carried", &config.carried, kProbability);
  reader.read("carried_without_odometry", &config.carried_without_odometry, kProbability);
  reader.read("misread", &config.misread, kProbability);
  reader.read("moved", &config.moved, kProbability);
  reader.read("moved_per_second", &config.moved_per_second, kProbability);
  reader.read("together", &config.together, kPositive);
  reader.read("mistaken_start", &config.mistaken_start, kProbability);
  reader.read("mistaken", &config.mistaken, kProbability);
  reader.read("missed", &config.missed, kProbability);
  reader.read("in_place", &config.in_place, kPositive);
  reader.read("odds", &config.odds, {1.0, 1e30});
  reader.read("odds_at_start", &config.odds_at_start, {1.0, 1e30});
  reader.read("open_deviation", &config.open_deviation, kNonNegative);
  return config;
}

}  // namespace omnitag
