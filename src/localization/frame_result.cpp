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

int FrameResult::acceptedMarkers() const {
  return static_cast<int>(std::count_if(detections.begin(), detections.end(),
                                        [](const MarkerDetection& d) { return d.accepted; }));
}

}  // namespace omnitag
