#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "camera/mounted_camera.h"
#include "omnitag/marker/marker_map.h"

namespace omnitag::test {

/// Black and white modules of a tag, white border included; true is white.
struct TagBitmap {
  int total_width = 0;
  int width_at_border = 0;
  std::vector<bool> white;
};

/// The tag as the AprilTag library draws it: tag36h11 and some families of other layouts.
TagBitmap tagBitmap(const std::string& family, int id);

/// The panorama of a robot among markers before a grey background: each sample of each pixel is a
/// line of sight, intersected with the markers' planes. Renders only `rows`; the others are black.
/// Misses markers that are narrower than two pixels. The borders of pictures must be whole numbers
/// of cells.
cv::Mat renderPanorama(const MarkerMap& map, const MountedCamera& camera, const Pose& map_from_base,
                       int samples_per_axis = 3, const cv::Range& rows = cv::Range::all());

}  // namespace omnitag::test
