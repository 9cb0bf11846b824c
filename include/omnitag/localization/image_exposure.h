#pragma once

#include <opencv2/core/mat.hpp>

namespace omnitag {

/// How well an image is exposed.
enum class ImageExposure { kGood, kTooDark, kTooBright, kWashedOut };

/// "" for a good one, "too dark", "too bright", "washed out".
const char* toString(ImageExposure exposure);

/// The exposure, judged by the grey levels of a sample of an image's pixels (CV_8UC1). Up to half
/// of the image may show nothing of the world, like the black around a mirror or a fisheye.
ImageExposure exposureOf(const cv::Mat& image);

}  // namespace omnitag
