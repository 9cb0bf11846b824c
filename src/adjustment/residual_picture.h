#pragma once

#include <opencv2/core/mat.hpp>

#include "adjustment/camera_calibration.h"

namespace omnitag {

/// A picture (CV_8UC3) of a calibration's residuals: each is a magnified arrow over an image of the
/// recording; beside it, the RMS by distance from the image's centre, along the radius and across
/// it. The residuals should be short, without a pattern.
///
/// `image`: one of the recording (CV_8UC1), for the background. `camera`: the calibrated one.
cv::Mat residualPicture(const CalibrationResult& result, const CameraModel& camera,
                        const cv::Mat& image);

}  // namespace omnitag
