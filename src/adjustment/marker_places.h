#pragma once

#include <optional>
#include <string>
#include <vector>

#include "omnitag/adjustment/map_builder.h"
#include "omnitag/adjustment/marker_estimate.h"
#include "recording.h"

namespace omnitag {

/// A place at which several readings of one marker agree.
struct MarkerHangsAt {
  Marker marker;
  /// In the order of time.
  std::vector<ReadingPlace> readings;
};

/// The places at which a marker hung while the recording was made, in the order in which they were
/// first seen; one for a marker that stayed. Readings that agree with too few others count nowhere.
std::vector<MarkerHangsAt> placesOf(const Recording& recording, std::size_t marker,
                                    const std::vector<ReadingPlace>& readings,
                                    const MapBuilderConfig& config);

/// The place and the size at which nearly all readings of a marker agree, where its size may be
/// another one than is taken for it; nothing where no size does. Of a marker that was moved, none
/// does.
std::optional<Marker> atAnotherSize(const Recording& recording, std::size_t marker,
                                    const std::vector<ReadingPlace>& readings,
                                    const MapBuilderConfig& config);

/// How often a marker was seen at another place than the time before.
std::size_t changesBetween(const std::vector<MarkerHangsAt>& places);

/// "marker 7 (door) moved by 0.40 m between 12.25 s and 13.00 s".
std::string describeMove(const Recording& recording, const std::vector<MarkerHangsAt>& places);

}  // namespace omnitag
