#pragma once

#include <cstddef>
#include <vector>

#include "adjustment/corner_residual.h"

namespace omnitag {

/// How well the corners of one image fit.
struct ImageResidual {
  /// s.
  double stamp = 0.0;
  /// Pixels, over the corners that are used; 0 if there are none.
  double rms = 0.0;
  /// Corners that are used, and those that are too far off or not seen at all: see summarize().
  std::size_t used = 0;
  std::size_t left_out = 0;
};

/// The residuals by image. `stamps`: of the frames that the corners refer to; the result is in
/// their order, with zeros for an image without corners.
std::vector<ImageResidual> imageResiduals(const std::vector<CornerResidual>& corners,
                                          const std::vector<double>& stamps);

/// Pixels, the median of the RMS of the images that have corners in use; 0 if none has.
double medianRms(const std::vector<ImageResidual>& images);

/// The indices of the images that stand out, the worst first: those with more than twice the median
/// RMS, and those with most of their corners left out, which come first of all.
std::vector<std::size_t> outstandingImages(const std::vector<ImageResidual>& images);

}  // namespace omnitag
