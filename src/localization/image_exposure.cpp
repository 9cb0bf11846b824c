#include "omnitag/localization/image_exposure.h"

#include <array>
#include <cstdint>

namespace omnitag {

const char* toString(ImageExposure exposure) {
  switch (exposure) {
    case ImageExposure::kTooDark:
      return "too dark";
    case ImageExposure::kTooBright:
      return "too bright";
    case ImageExposure::kWashedOut:
      return "washed out";
    case ImageExposure::kGood:
      break;
  }
  return "";
}

ImageExposure exposureOf(const cv::Mat& image) {
  constexpr int kStep = 16;  // pixels
  std::array<int, 256> counts{};
  int all = 0;
  for (int row = kStep / 2; row < image.rows; row += kStep) {
    const auto* const pixels = image.ptr<std::uint8_t>(row);
    for (int column = kStep / 2; column < image.cols; column += kStep, ++all) {
      ++counts[pixels[column]];
    }
  }
  // The grey level below which this share of the pixels lies.
  const auto quantile = [&](double share) {
    int below = 0;
    int level = 0;
    while (level < 255 && below + counts[static_cast<std::size_t>(level)] <= share * all) {
      below += counts[static_cast<std::size_t>(level++)];
    }
    return level;
  };
  constexpr int kDark = 50;
  constexpr int kSaturated = 250;
  constexpr int kPale = 40;
  const int bright = quantile(0.99);
  if (bright < kDark) return ImageExposure::kTooDark;
  if (quantile(0.75) >= kSaturated) return ImageExposure::kTooBright;
  // Only the brighter half counts: the darker half may show nothing of the world.
  if (bright - quantile(0.5) < kPale && bright - quantile(0.05) < kPale) {
    return ImageExposure::kWashedOut;
  }
  return ImageExposure::kGood;
}

}  // namespace omnitag
