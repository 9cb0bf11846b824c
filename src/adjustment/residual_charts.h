#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "adjustment/corner_residual.h"
#include "adjustment/image_residuals.h"
#include "omnitag/camera/camera_model.h"

/// Charts of residuals, each drawn over a white picture (CV_8UC3) that it fills.
namespace omnitag {

/// The RMS by distance from the image's centre, along the radius and across it (bars).
void drawRadiusChart(const std::vector<CornerResidual>& corners, const CameraModel& camera,
                     cv::Mat chart);

/// The RMS of each image over the time since the first (s). Images that stand out are red; the
/// worst of them have their stamps beside them, as far as there is room.
void drawTimeChart(const std::vector<ImageResidual>& images, cv::Mat chart);

}  // namespace omnitag
