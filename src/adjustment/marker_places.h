#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adjustment/map_builder.h"
#include "adjustment/marker_estimate.h"
#include "adjustment/recording.h"

namespace omnitag {

/// A place at which several readings of one marker agree.
struct MarkerPlace {
  Marker marker;
  /// In temporal order.
  std::vector<ReadingIndex> readings;
};

/// The places where a marker hung during the recording, in the order in which they were first seen;
/// a single one for a marker that stayed. Readings that agree with too few others belong to no
/// place.
std::vector<MarkerPlace> placesOf(const Recording& recording, std::size_t marker,
                                  const std::vector<ReadingIndex>& readings,
                                  const MapBuilderConfig& config);

/// The place and the size at which nearly all readings of a marker agree, if its assumed size may
/// be wrong; nothing if no other size makes them agree, as for a marker that was moved.
std::optional<Marker> atAnotherSize(const Recording& recording, std::size_t marker,
                                    const std::vector<ReadingIndex>& readings,
                                    const MapBuilderConfig& config);

/// How often a marker was seen at another place than before.
std::size_t changesBetween(const std::vector<MarkerPlace>& places);

/// "marker 7 (door) moved by 0.40 m between 12.25 s and 13.00 s".
std::string describeMove(const Recording& recording, const std::vector<MarkerPlace>& places);

}  // namespace omnitag
