#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

namespace omnitag {

/// An image (CV_8UC1) that was blurred by this many pixels (standard deviation), as sharp as noise
/// allows; the image itself where it was hardly blurred. What decoders look for are modules of some
/// pixels, which two steps of Van Cittert's iteration bring back.
cv::Mat sharpened(const cv::Mat& image, double blur);

/// An image as decoders read it: sharpened where it is blurred, once they ask for it.
class ReadableImage {
 public:
  ReadableImage() = default;
  ReadableImage(const cv::Mat& image, double blur) : image_(image), blur_(blur) {}

  /// Not from two threads at once.
  const cv::Mat& get() {
    if (!sharpened_) sharpened_ = sharpened(image_, blur_);
    return *sharpened_;
  }

 private:
  cv::Mat image_;
  double blur_ = 0.0;
  std::optional<cv::Mat> sharpened_;
};

}  // namespace omnitag
