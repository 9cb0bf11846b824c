#include "omnitag/localization/marker_memory.h"

#include <algorithm>

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

void MarkerMemory::addSeen(const RememberedSighting& sighting) {
  Record& record = of(sighting.observation.map_entry);
  addFirst(record, true);
  record.seen = sighting.stamp;
  record.misses = 0;
  record.in_place = sighting;
  record.elsewhere.reset();
}

void MarkerMemory::addElsewhere(const RememberedSighting& sighting, bool is_certain) {
  Record& record = of(sighting.observation.map_entry);
  record.elsewhere = sighting;
  record.is_certain = is_certain;
}

void MarkerMemory::takeFrom(const MarkerMemory& before,
                            const std::vector<std::optional<std::size_t>>& entries) {
  stamp_ = before.stamp_;
  first_looks_ = before.first_looks_;
  first_seen_ = before.first_seen_;
  records_.clear();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!entries[i] || *entries[i] >= before.records_.size()) continue;
    Record& record = of(i);
    record = before.records_[*entries[i]];
    if (record.in_place) record.in_place->observation.map_entry = i;
    if (record.elsewhere) record.elsewhere->observation.map_entry = i;
  }
}

bool MarkerMemory::isElsewhere(std::size_t entry) const {
  return elsewhere(entry) != nullptr && records_[entry].is_certain;
}

std::size_t MarkerMemory::countInPlace() const {
  return static_cast<std::size_t>(
      std::count_if(records_.begin(), records_.end(),
                    [](const Record& record) { return record.in_place.has_value(); }));
}

const RememberedSighting* MarkerMemory::inPlace(std::size_t entry) const {
  const bool is_known = entry < records_.size() && records_[entry].in_place;
  return is_known ? &*records_[entry].in_place : nullptr;
}

const RememberedSighting* MarkerMemory::elsewhere(std::size_t entry) const {
  const bool is_known = entry < records_.size() && records_[entry].elsewhere;
  return is_known ? &*records_[entry].elsewhere : nullptr;
}

void MarkerMemory::forgetPlaces() {
  for (Record& record : records_) {
    record.in_place.reset();
    record.elsewhere.reset();
  }
}

void MarkerMemory::addMissed(std::size_t entry, const Eigen::Vector3d& viewpoint, double stamp) {
  Record& record = of(entry);
  addFirst(record, false);
  record.missed = stamp;
  record.missed_from = viewpoint;
  ++record.misses;
}

void MarkerMemory::addFirst(const Record& record, bool is_seen) {
  if (record.seen > kNever || record.missed > kNever) return;
  first_looks_ += 1.0;
  if (is_seen) first_seen_ += 1.0;
}

void MarkerMemory::addLost(std::size_t entry) { of(entry).seen = kNever; }

double MarkerMemory::seenAtFirst() const {
  return std::clamp((first_seen_ + 1.0) / (first_looks_ + 2.0), 0.1, 0.9);
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

bool MarkerMemory::wasMissed(std::size_t entry) const {
  return entry < records_.size() && records_[entry].missed > records_[entry].seen;
}

bool MarkerMemory::wasSeenSince(std::size_t entry, double stamp) const {
  return entry < records_.size() && records_[entry].seen >= stamp;
}

}  // namespace omnitag
