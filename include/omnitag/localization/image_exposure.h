#pragma once

#include <opencv2/core/mat.hpp>

namespace omnitag {

/// How well an image is exposed.
enum class ImageExposure { kGood, kTooDark, kTooBright, kWashedOut };

/// "" for a good one, "too dark", "too bright", "washed out".
const char* toString(ImageExposure exposure);

/// By the grey levels of some of an image's pixels (CV_8UC1). What shows no world, black around a
/// mirror or a fisheye, must not be more than half of them.
ImageExposure exposureOf(const cv::Mat& image);

}  // namespace omnitag
