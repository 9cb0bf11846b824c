#include "marker/sharpening.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace omnitag {

cv::Mat sharpened(const cv::Mat& image, double blur) {
  constexpr double kHardlyBlurred = 1.0;
  constexpr double kReach = 2.5;  // standard deviations
  if (blur < kHardlyBlurred) return image;
  constexpr int kSteps = 2;
  const int width = 2 * cvRound(kReach * blur) + 1;
  cv::Mat blurred;
  image.convertTo(blurred, CV_32F);
  cv::Mat sharp = blurred.clone();
  for (int step = 0; step < kSteps; ++step) {
    cv::Mat blurred_again;
    cv::GaussianBlur(sharp, blurred_again, {width, width}, blur);
    sharp += blurred - blurred_again;
  }
  cv::Mat result;
  sharp.convertTo(result, CV_8U);
  return result;
}

}  // namespace omnitag
