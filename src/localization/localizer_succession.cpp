#include <optional>
#include <utility>
#include <vector>

#include "localization/camera_state.h"
#include "localization/localizer_impl.h"
#include "marker/marker_selection.h"

namespace omnitag {
namespace {

bool hangsAlike(const Marker& a, const Marker& b) {
  return a.size == b.size && a.map_from_marker.isApprox(b.map_from_marker, 0.0);
}

/// For each marker of a map, the same marker in the same place of another map.
std::vector<std::optional<std::size_t>> sameEntries(const MarkerMap& map, const MarkerMap& other) {
  std::vector<std::optional<std::size_t>> entries;
  entries.reserve(map.markers.size());
  for (const Marker& marker : map.markers) {
    const auto like = entryLike(other, marker);
    const bool is_same = like && hangsAlike(other.markers[*like], marker);
    entries.push_back(is_same ? like : std::nullopt);
  }
  return entries;
}

}  // namespace

void Localizer::Impl::continueFrom(const Impl& before) {
  const std::vector<std::optional<std::size_t>> entries = sameEntries(map_, before.map_);
  const MarkerMemory empty(config_.attention);
  hypotheses_ = before.hypotheses_;
  for (Hypothesis& hypothesis : hypotheses_) {
    const MarkerMemory memory = std::exchange(hypothesis.memory, empty);
    hypothesis.memory.takeFrom(memory, entries);
    hypothesis.motion.configure(config_.motion);
  }
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    cameras_[i]->knowledge = before.cameras_[i]->knowledge;
  }
  image_lag_ = before.image_lag_;
  given_pose_ = before.given_pose_;
  last_stamp_ = before.last_stamp_;
  next_doubt_ = before.next_doubt_;
  measured_ = before.measured_;
  was_tracked_ = before.was_tracked_;
}

}  // namespace omnitag
