#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "adjustment/bundle.h"

namespace omnitag {

/// One corner of one marker in one frame.
struct CornerResidual {
  std::size_t frame = 0;
  std::size_t landmark = 0;
  /// Where it was measured, in pixels.
  Eigen::Vector2d pixel;
  /// Predicted minus measured position, in pixels; nothing if the corner should not be visible.
  std::optional<Eigen::Vector2d> residual;
};

/// The residuals of all corners, observation by observation.
std::vector<CornerResidual> cornerResiduals(const Bundle& bundle);

/// Residuals of corners, in pixels.
struct ResidualSummary {
  /// Pixels, over the corners that are used; and their number.
  double rms = 0.0;
  std::size_t counted = 0;
  /// Corners that are too far off to be used for the camera, or are not seen at all.
  std::size_t left_out = 0;
};
ResidualSummary summarize(const std::vector<CornerResidual>& residuals);

}  // namespace omnitag
