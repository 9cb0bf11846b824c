#include "localization/marker_memory.h"

#include <algorithm>
#include <utility>

#include "common/yaml_reader.h"

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

MarkerMemory::Looks& MarkerMemory::looksOf(std::size_t entry) {
  std::vector<Looks>& looks = of(entry).looks;
  if (camera_ >= looks.size()) looks.resize(camera_ + 1);
  return looks[camera_];
}

const MarkerMemory::Looks& MarkerMemory::looksAt(std::size_t entry) const {
  static const Looks kNone;
  const bool is_known = entry < records_.size() && camera_ < records_[entry].looks.size();
  return is_known ? records_[entry].looks[camera_] : kNone;
}

void MarkerMemory::addSeen(const RememberedSighting& sighting) {
  Looks& looks = looksOf(sighting.observation.map_entry);
  addFirst(looks, true);
  looks.seen = sighting.stamp;
  looks.misses = 0;
  Record& record = of(sighting.observation.map_entry);
  record.times_in_place = record.elsewhere ? 1 : record.times_in_place + 1;
  record.in_place = sighting;
  record.elsewhere.reset();
}

void MarkerMemory::addElsewhere(const RememberedSighting& sighting, std::size_t group) {
  Record& record = of(sighting.observation.map_entry);
  if (!record.elsewhere) record.elsewhere_since = sighting.stamp;
  record.elsewhere = sighting;
  record.group = group;
}

void MarkerMemory::takeFrom(const MarkerMemory& before,
                            const std::vector<std::optional<std::size_t>>& entries) {
  first_looks_ = before.first_looks_;
  first_seen_ = before.first_seen_;
  groups_ = before.groups_;
  records_.clear();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!entries[i] || *entries[i] >= before.records_.size()) continue;
    Record& record = of(i);
    record = before.records_[*entries[i]];
    if (record.in_place) record.in_place->observation.map_entry = i;
    if (record.elsewhere) record.elsewhere->observation.map_entry = i;
  }
}

bool MarkerMemory::hasElsewhere() const {
  return std::any_of(records_.begin(), records_.end(),
                     [](const Record& record) { return record.elsewhere.has_value(); });
}

std::size_t MarkerMemory::countInPlace() const {
  return static_cast<std::size_t>(std::count_if(
      records_.begin(), records_.end(),
      [](const Record& record) { return record.in_place.has_value() && !record.elsewhere; }));
}

void MarkerMemory::addGroup(const std::vector<RememberedSighting>& sightings,
                            const std::optional<Eigen::Isometry3d>& motion) {
  std::optional<std::size_t> group;
  for (const RememberedSighting& sighting : sightings) {
    const std::size_t entry = sighting.observation.map_entry;
    if (!isElsewhere(entry)) continue;
    // A group with a known motion takes precedence over a single marker.
    const std::size_t before = records_[entry].group;
    if (!group || (groups_[before] && !groups_[*group])) group = before;
  }
  if (!group) group = newGroup(motion);
  if (motion) groups_[*group] = motion;
  for (const RememberedSighting& sighting : sightings) addElsewhere(sighting, *group);
}

void MarkerMemory::addElsewhere(const RememberedSighting& sighting,
                                const Contradicts& contradicts) {
  const std::size_t entry = sighting.observation.map_entry;
  if (isElsewhere(entry)) return addElsewhere(sighting, records_[entry].group);
  for (const DisplacedGroup& group : displacedGroups()) {
    if (!group.motion || contradicts(sighting, *group.motion)) continue;
    return addElsewhere(sighting, records_[group.entries.front()].group);
  }
  addElsewhere(sighting, newGroup(std::nullopt));
}

std::size_t MarkerMemory::newGroup(const std::optional<Eigen::Isometry3d>& motion) {
  for (std::size_t group = 0; group < groups_.size(); ++group) {
    const bool is_used = std::any_of(records_.begin(), records_.end(), [&](const Record& record) {
      return record.elsewhere && record.group == group;
    });
    if (is_used) continue;
    groups_[group] = motion;
    return group;
  }
  groups_.push_back(motion);
  return groups_.size() - 1;
}

std::vector<DisplacedGroup> MarkerMemory::displacedGroups() const {
  std::vector<DisplacedGroup> groups(groups_.size());
  for (std::size_t group = 0; group < groups_.size(); ++group) {
    groups[group].motion = groups_[group];
  }
  for (std::size_t entry = 0; entry < records_.size(); ++entry) {
    if (records_[entry].elsewhere) groups[records_[entry].group].entries.push_back(entry);
  }
  groups.erase(std::remove_if(groups.begin(), groups.end(),
                              [](const DisplacedGroup& group) { return group.entries.empty(); }),
               groups.end());
  return groups;
}

void MarkerMemory::moveBy(const Eigen::Isometry3d& motion, const Contradicts& contradicts) {
  const auto move = [&motion](RememberedSighting* sighting) {
    sighting->map_from_base = Pose::fromIsometry(motion * sighting->map_from_base.toIsometry());
  };
  for (std::optional<Eigen::Isometry3d>& group : groups_) {
    if (group) group = *group * motion.inverse();
  }
  groups_.emplace_back(motion.inverse());
  const std::size_t of_motion = groups_.size() - 1;
  for (Record& record : records_) {
    if (record.elsewhere) {
      const bool is_in_place = !contradicts(*record.elsewhere, motion);
      move(&*record.elsewhere);
      if (is_in_place) {
        record.in_place = std::exchange(record.elsewhere, std::nullopt);
      } else {
        record.in_place.reset();
      }
    } else if (record.in_place) {
      const bool is_elsewhere = contradicts(*record.in_place, motion);
      move(&*record.in_place);
      if (!is_elsewhere) continue;
      record.elsewhere_since = record.in_place->stamp;
      record.elsewhere = std::exchange(record.in_place, std::nullopt);
      record.group = of_motion;
    }
  }
}

const RememberedSighting* MarkerMemory::inPlace(std::size_t entry) const {
  const bool is_known = entry < records_.size() && records_[entry].in_place;
  return is_known ? &*records_[entry].in_place : nullptr;
}

const RememberedSighting* MarkerMemory::elsewhere(std::size_t entry) const {
  const bool is_known = entry < records_.size() && records_[entry].elsewhere;
  return is_known ? &*records_[entry].elsewhere : nullptr;
}

void MarkerMemory::clear() {
  records_.clear();
  groups_.clear();
}

void MarkerMemory::forgetPlaces() {
  groups_.clear();
  for (Record& record : records_) {
    record.in_place.reset();
    record.elsewhere.reset();
  }
}

void MarkerMemory::addMissed(std::size_t entry, const Eigen::Vector3d& viewpoint, double stamp) {
  Looks& looks = looksOf(entry);
  addFirst(looks, false);
  looks.missed = stamp;
  looks.missed_from = viewpoint;
  ++looks.misses;
}

void MarkerMemory::addFirst(const Looks& looks, bool is_seen) {
  if (looks.seen > kNever || looks.missed > kNever) return;
  first_looks_ += 1.0;
  if (is_seen) first_seen_ += 1.0;
}

void MarkerMemory::addLost(std::size_t entry) { looksOf(entry).seen = kNever; }

double MarkerMemory::seenAtFirst() const {
  return std::clamp((first_seen_ + 1.0) / (first_looks_ + 2.0), 0.1, 0.9);
}

bool MarkerMemory::isHidden(std::size_t entry, const Eigen::Vector3d& viewpoint,
                            double stamp) const {
  // A single miss may be a person who walked by.
  constexpr int kFewest = 2;
  const Looks& looks = looksAt(entry);
  return looks.misses >= kFewest && stamp < looks.missed + config_.hidden_time &&
         (viewpoint - looks.missed_from).norm() < config_.hidden_way;
}

bool MarkerMemory::wasSeen(std::size_t entry) const {
  return looksAt(entry).seen > looksAt(entry).missed;
}

bool MarkerMemory::wasMissed(std::size_t entry) const {
  return looksAt(entry).missed > looksAt(entry).seen;
}

bool MarkerMemory::wasSeenSince(std::size_t entry, double stamp) const {
  return looksAt(entry).seen >= stamp;
}

}  // namespace omnitag
