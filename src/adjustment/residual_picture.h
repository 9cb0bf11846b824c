#pragma once

#include <opencv2/core/mat.hpp>

#include "adjustment/camera_calibration.h"

namespace omnitag {

/// A picture (CV_8UC3) of a calibration's residuals: each as a magnified arrow over the image in
/// which it was measured; next to it the RMS by distance from the image's centre, along the radius
/// and across it. The residuals should be short, without a pattern.
///
/// `image`: one of the recording (CV_8UC1), for the background. `camera`: the calibrated one.
cv::Mat residualPicture(const CalibrationResult& result, const CameraModel& camera,
                        const cv::Mat& image);

}  // namespace omnitag
