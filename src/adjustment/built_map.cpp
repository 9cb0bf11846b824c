#include "adjustment/built_map.h"

#include "adjustment/marker_estimate.h"

namespace omnitag {
namespace {

MarkerEstimate estimateOf(const BuiltMarker& marker) {
  MarkerEstimate estimate;
  estimate.covariance = marker.covariance;
  return estimate;
}

}  // namespace

double BuiltMarker::positionDeviation() const { return estimateOf(*this).positionDeviation(); }

double BuiltMarker::orientationDeviation() const {
  return estimateOf(*this).orientationDeviation();
}

MarkerMap BuiltMap::map(const std::string& frame_id) const {
  MarkerMap map;
  map.frame_id = frame_id;
  for (const BuiltMarker& marker : markers) map.markers.push_back(marker.marker);
  return map;
}

}  // namespace omnitag
