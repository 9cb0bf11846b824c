#pragma once

#include <opencv2/core/matx.hpp>
#include <vector>

#include "planning/floor_prediction.h"

namespace omnitag {

/// Colours for deviations on a logarithmic scale, from blue for the smallest through pale yellow to
/// red, which colour-blind people can tell apart, too.
class ColourScale {
 public:
  /// Covers nearly all of a floor's position deviations.
  explicit ColourScale(const FloorPrediction& floor);

  /// From 0 to 1 along the scale, for a deviation in metres.
  double shareOf(double deviation) const;
  /// B, G, R.
  static cv::Vec3b colourAt(double share);
  cv::Vec3b colourOf(double deviation) const { return colourAt(shareOf(deviation)); }

  /// m: round numbers along the scale, its ends included; at least two.
  const std::vector<double>& ticks() const { return ticks_; }

 private:
  std::vector<double> ticks_;
};

}  // namespace omnitag
