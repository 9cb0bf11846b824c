#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

namespace omnitag {

/// An image (CV_8UC1) that was blurred by this many pixels (standard deviation), as sharp as noise
/// allows; the image itself if it was hardly blurred. Decoders need modules of a few pixels, which
/// two steps of Van Cittert's iteration restore.
cv::Mat sharpened(const cv::Mat& image, double blur);

/// An image as decoders read it: sharpened if it is blurred, on first use.
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
