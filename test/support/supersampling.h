#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace omnitag::test {

/// Grey levels at a share of white of 0 and of 1.
struct Tones {
  double black = 0.0;
  double white = 255.0;
};

/// Fills a part of an image (CV_8UC1): each pixel gets the mean over its area of `whiteAt(u, v)`,
/// the share of white at a position. The pixels' middles are at whole numbers.
template <typename WhiteAt>
void supersample(const cv::Rect& part, const Tones& tones, const WhiteAt& whiteAt, cv::Mat* image) {
  constexpr int kSamples = 6;  // along either side of a pixel
  for (int v = part.y; v < part.br().y; ++v) {
    for (int u = part.x; u < part.br().x; ++u) {
      double white = 0.0;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        white += whiteAt(u + (i % kSamples + 0.5) / kSamples - 0.5,
                         v + (i / kSamples + 0.5) / kSamples - 0.5);
      }
      image->at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(
          tones.black + (tones.white - tones.black) * white / (kSamples * kSamples));
    }
  }
}

}  // namespace omnitag::test
