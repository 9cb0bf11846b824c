#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "omnitag/marker/marker_map.h"

namespace omnitag {

/// Places the corners of a decoded tag where the straight lines through its edges meet.
///
/// Across each edge the image is averaged from the middle of the module inside to the middle of the
/// module outside, 3 pixels at most. Both modules are uniform, one dark and one bright, so the mean
/// grey level determines where the step between them is, however blurred it is and wherever it
/// falls between pixels. Many such places along the edge give its line.
///
/// `image`: CV_8UC1. `corners`: pixels, the centre of the top-left pixel at (0, 0), within half a
/// module of the truth. `modules_per_edge`: the number of modules between two corners. An edge that
/// has no contrast, or of which more than half is outside the image, stays as it is.
Corners<Eigen::Vector2d> refineCorners(const cv::Mat& image,
                                       const Corners<Eigen::Vector2d>& corners,
                                       int modules_per_edge);

}  // namespace omnitag
