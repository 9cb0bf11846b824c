#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "adjustment/corner_residual.h"
#include "omnitag/camera/camera_model.h"

namespace omnitag {

/// The residuals of an adjustment.
struct PicturedResiduals {
  std::vector<CornerResidual> corners;
  /// s, of the frames that the corners refer to.
  std::vector<double> stamps;
  /// Pixels, RMS before the adjustment, if it is known.
  std::optional<double> rms_before = {};
};

/// A picture (CV_8UC3) of residuals: each is a magnified arrow over an image of the recording, in
/// which cells of the field without any corner are tinted; beside it, the RMS by distance from the
/// image's centre, along the radius and across it; below it, the RMS over time. The residuals
/// should be short, without a pattern.
///
/// `camera`: the one that the residuals are relative to. `image`: one of the recording (CV_8UC1),
/// for the background.
cv::Mat residualPicture(const PicturedResiduals& residuals, const CameraModel& camera,
                        const cv::Mat& image);

}  // namespace omnitag
