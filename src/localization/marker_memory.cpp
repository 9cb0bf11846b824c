#include "omnitag/localization/marker_memory.h"

namespace omnitag {

AttentionConfig readAttentionConfig(const YamlReader& reader) {
  reader.allowOnly({"period", "max_pixels", "hidden_way", "hidden_time"});
  AttentionConfig config;
  reader.read("period", &config.period, kPositive);
  reader.read("max_pixels", &config.max_pixels, {1000, 100000000});
  reader.read("hidden_way", &config.hidden_way, kNonNegative);
  reader.read("hidden_time", &config.hidden_time, kNonNegative);
  return config;
}

MarkerMemory::Record& MarkerMemory::of(std::size_t entry) {
  if (entry >= records_.size()) records_.resize(entry + 1);
  return records_[entry];
}

void MarkerMemory::addSeen(std::size_t entry, double stamp) {
  Record& record = of(entry);
  record.seen = stamp;
  record.misses = 0;
}

void MarkerMemory::addMissed(std::size_t entry, const Eigen::Vector3d& viewpoint, double stamp) {
  Record& record = of(entry);
  record.missed = stamp;
  record.missed_from = viewpoint;
  ++record.misses;
}

bool MarkerMemory::isHidden(std::size_t entry, const Eigen::Vector3d& viewpoint,
                            double stamp) const {
  // Once, a person may have walked by.
  constexpr int kFewest = 2;
  if (entry >= records_.size()) return false;
  const Record& record = records_[entry];
  return record.misses >= kFewest && stamp < record.missed + config_.hidden_time &&
         (viewpoint - record.missed_from).norm() < config_.hidden_way;
}

bool MarkerMemory::wasSeen(std::size_t entry) const {
  return entry < records_.size() && records_[entry].seen > records_[entry].missed;
}

bool MarkerMemory::wasSeenSince(std::size_t entry, double stamp) const {
  return entry < records_.size() && records_[entry].seen >= stamp;
}

}  // namespace omnitag
