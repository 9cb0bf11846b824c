#include "omnitag/localization/frame_result.h"

#include <algorithm>

namespace omnitag {
namespace {

PoseEstimate published(const PoseEstimate& estimate, bool is_on_floor) {
  PoseEstimate published = estimate;
  if (is_on_floor) published.pose = published.pose.onFloor();
  return published;
}

}  // namespace

const char* toString(Mode mode) {
  switch (mode) {
    case Mode::kSearching:
      return "searching";
    case Mode::kTracking:
      return "tracking";
    case Mode::kDeadReckoning:
      return "dead_reckoning";
    case Mode::kFound:
      return "found";
  }
  return "";
}

PoseEstimate FrameResult::publishedPose() const { return published(*map_from_base, is_on_floor); }

std::optional<PoseEstimate> FrameResult::publishedMeasurement() const {
  return measured ? std::optional(published(*measured, is_on_floor)) : std::nullopt;
}

int FrameResult::acceptedMarkers() const {
  return static_cast<int>(std::count_if(detections.begin(), detections.end(),
                                        [](const MarkerDetection& d) { return d.accepted; }));
}

}  // namespace omnitag
