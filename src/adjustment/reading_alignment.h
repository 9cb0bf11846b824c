#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "camera/mounted_camera.h"
#include "marker/marker_reader.h"
#include "marker/tag_pattern.h"
#include "measurement/pose_prior.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// The readings of a panorama (CV_8UC1) with their corners located by all of the markers' pixels,
/// several times more exactly than decoding does. The camera must be known to about half a pixel.
/// Readings that no marker of the map explains, or whose pixels do not fit, are left out; all of
/// them are if they do not determine the robot's pose. `standing`: what is known of the pose
/// beforehand.
std::vector<MarkerReading> alignReadings(const cv::Mat& panorama, const MarkerMap& map,
                                         const TagPatterns& patterns, const MountedCamera& camera,
                                         const PosePrior& standing,
                                         std::vector<MarkerReading> readings);

}  // namespace omnitag
