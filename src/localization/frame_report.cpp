#include <limits>
#include <utility>

#include "localization/frame_tracker.h"

namespace omnitag {

void FrameTracker::report() {
  for (std::size_t k = 0; k < observed_.size(); ++k) {
    const MarkerObservation& observation = *sightings_[observed_[k]].observation;
    const Marker& marker = tools_.map.markers[observation.map_entry];
    MarkerDetection detection = toDetection(observation, marker);
    detection.accepted = solution_ && solution_->used[k];
    detection.residual =
        solution_ ? solution_->misfits[k].residual : std::numeric_limits<double>::quiet_NaN();
    detection.deviations =
        solution_ ? solution_->misfits[k].deviations : std::numeric_limits<double>::quiet_NaN();
    if (!detection.accepted) {
      detection.reason = solution_ ? "disagrees with the other markers" : "no pose agrees with it";
    }
    result_->detections.push_back(std::move(detection));
  }
  for (const Sighting& sighting : sightings_) {
    if (!sighting.observation || !sighting.is_elsewhere) continue;
    const std::size_t entry = sighting.observation->map_entry;
    MarkerDetection detection = toDetection(*sighting.observation, tools_.map.markers[entry]);
    detection.reason = kElsewhere;
    result_->elsewhere.push_back(entry);
    result_->detections.push_back(std::move(detection));
  }
  for (Stranger& stranger : strangers_) {
    result_->detections.push_back(toDetection(stranger.reading));
    result_->detections.back().reason = std::move(stranger.reason);
  }
}

void FrameTracker::reportMissed() {
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    const Sighting& sighting = sightings_[i];
    if (sighting.observation || !(sighting.looked_at || sighting.was_decoded)) continue;
    result_->missed.push_back(result_->predicted[i].map_entry);
  }
}

}  // namespace omnitag
