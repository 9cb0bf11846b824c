#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "omnitag/marker/marker_map.h"
#include "planning/floor_prediction.h"
#include "planning/occupancy_grid.h"

namespace omnitag {

/// A plan of the building from above (CV_8UC3, BGR): the floor coloured by the position deviation
/// on a logarithmic scale, hatched where fewer than three markers are recognized; walls; the
/// markers with their ids, the last `added` of the map in another colour; and a legend.
cv::Mat planPicture(const OccupancyGrid& grid, const FloorPrediction& floor, const MarkerMap& map,
                    std::size_t added);

}  // namespace omnitag
