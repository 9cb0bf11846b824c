#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "omnitag/adjustment/bundle.h"

namespace omnitag {

/// One corner of one marker in one frame.
struct CornerResidual {
  std::size_t frame = 0;
  std::size_t landmark = 0;
  /// Where it was measured, in pixels.
  Eigen::Vector2d pixel;
  /// Where it should be, less where it was measured, in pixels; nothing where it should not be
  /// seen.
  std::optional<Eigen::Vector2d> residual;
};

/// Of all corners, observation by observation.
std::vector<CornerResidual> cornerResiduals(const Bundle& bundle);

/// Residuals of corners, in pixels.
struct ResidualSummary {
  /// Over the corners that count, and how many these are.
  double rms = 0.0;
  std::size_t counted = 0;
  /// Corners that are so far off that they say nothing about the camera, or are not seen at all.
  std::size_t left_out = 0;
};
ResidualSummary summarize(const std::vector<CornerResidual>& residuals);

}  // namespace omnitag
