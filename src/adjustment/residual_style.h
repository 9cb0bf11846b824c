#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "common/drawing.h"

/// What the parts of a residual picture have in common. Colours are B, G, R.
namespace omnitag::residual_style {

inline const cv::Scalar kBlack(0, 0, 0);
inline const cv::Scalar kGood(40, 160, 40);
inline const cv::Scalar kBad(30, 30, 220);
inline constexpr double kTextSize = 0.45;

inline void write(const std::string& text, const cv::Point& place, cv::Mat* picture,
                  const cv::Scalar& colour = kBlack) {
  writeText(text, place, colour, kTextSize, picture);
}

}  // namespace omnitag::residual_style
