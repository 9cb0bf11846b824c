#include "omnitag/localization/frame_result.h"

#include <algorithm>

namespace omnitag {

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

PoseEstimate FrameResult::publishedPose() const {
  PoseEstimate published = *map_from_base;
  if (is_on_floor) published.pose = published.pose.onFloor();
  return published;
}

int FrameResult::acceptedMarkers() const {
  return static_cast<int>(std::count_if(detections.begin(), detections.end(),
                                        [](const MarkerDetection& d) { return d.accepted; }));
}

}  // namespace omnitag
