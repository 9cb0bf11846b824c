#pragma once

#include <opencv2/core/mat.hpp>

#include "adjustment/built_map.h"

namespace omnitag {

/// A map from above (CV_8UC3): markers with their fronts and ids, the robot's path, and a legend.
/// Around each marker that was found is the ellipse of its standard deviations; around the seed's
/// place, dashed, that of the seed. Ellipses, and how far a marker is from the seed's place, are
/// magnified alike, by what the legend says. A marker that hangs too far away from the seed's place
/// for that has its outline there in grey.
cv::Mat mapPicture(const BuiltMap& map);

}  // namespace omnitag
